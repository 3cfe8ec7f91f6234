// Recorded depth images of rooms, and random poses of a tool in front of their surface.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/pose.h"

namespace vpm::bench {

struct RecordedImage {
  std::string name;
  Cloud cloud;
};

// Throws Error(usage) if `folder`/depth holds none of the images known by name. Suites call it at
// their start, before minutes have passed.
void require_recorded_images(const std::string& folder);

// Reads the images that are there and that this build can read. Throws what import_cloud throws for
// a damaged one.
std::vector<RecordedImage> recorded_images(const std::string& folder);

// Returns the k-th random pose: near a random point, on its free side, about a tool's reach off.
Pose random_pose_before(const Cloud& cloud, std::uint64_t k, double reach);

}  // namespace vpm::bench
