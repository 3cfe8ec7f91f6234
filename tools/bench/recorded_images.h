// Recorded depth images of rooms, random poses of a tool in front of their surface, and the measure
// there beside a brute-force count of the tool's places behind the image.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/pose.h"
#include "libvpm/device/device.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"

namespace vpm::bench {

struct RecordedImage {
  std::string name;
  Cloud cloud;
};

// Throws Error(invalid_argument) if `folder`/depth holds none of the images known by name. Suites
// call it at their start, before minutes have passed.
void require_recorded_images(const std::string& folder);

// Reads the images that are there and that this build can read. Throws what import_cloud throws for
// a damaged one.
std::vector<RecordedImage> recorded_images(const std::string& folder);

// Returns the k-th random pose: near a random point, on its free side, about a tool radius off.
Pose random_pose_before(const Cloud& cloud, std::uint64_t k, double reach);

// Largest fraction of the tool inside, by the count, of the poses that are compared. The count
// takes occluded space as solid, as Shadows::solid does. Shadows::near is also
// compared without occluded places, which lie further behind the surface than the tool radius and
// may count or not.
inline constexpr double kShallow = 0.1;
inline constexpr double kFrameBound = 0.05;  // in parts of the tool's volume

struct FrameResult {
  std::string frame;
  int poses = 0;
  // Statistics of |volume - count|, with the number of poses above kFrameBound.
  struct Difference {
    MeanAndWorst all;
    int beyond = 0;
    void add(double difference) {
      all.add(difference);
      beyond += difference > kFrameBound;
    }
  };
  Difference solid, near, paper;  // Measure::refined by its occluded space, Measure::paper
  Difference without_occluded;    // `near` where occluded places may count or not
  int counted_in_free_space = 0;  // spheres of solid and near, over all poses
};

// Compares `poses` random shallow poses in each recording that lies in `folder`/depth and that this
// build can read. Throws what import_cloud throws for a damaged one.
std::vector<FrameResult> run_real_frames(const std::string& folder, const PackedSolid& tool,
                                         std::uint32_t level, int poses, const Device& device);

}  // namespace vpm::bench
