// Recorded depth images of rooms, and places of a tool before what they show.
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

// Throws Error(invalid_argument) where `folder`/depth holds none of those that are known by name;
// for the start of a suite, since what is found out later costs minutes.
void require_recorded_images(const std::string& folder);

// Those that are there and can be read by this build. Throws what import_cloud throws for damaged
// ones.
std::vector<RecordedImage> recorded_images(const std::string& folder);

// The k-th: on the near side of a random point, about a tool's reach off.
Pose random_pose_before(const Cloud& cloud, std::uint64_t k, double reach);

}  // namespace vpm::bench
