// Recorded depth images: the measure beside a brute-force count of the tool's places that lie
// behind the depth of their nearest pixel.
#pragma once

#include <string>
#include <vector>

#include "libvpm/device/device.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"

namespace vpm::bench {

// The count takes the shadow of an object for its inside, as Shadows::solid does. Of Shadows::near
// it is compared without the places in a shadow, too: those further behind the surface than the
// tool's reach may count or not.
inline constexpr double kShallow = 0.1;  // of the tool: poses of which it says more are left out
inline constexpr double kFrameBound = 0.05;  // of the tool

struct FrameResult {
  std::string frame;
  int poses = 0;
  // |volume - count|, and how many poses have more than kFrameBound.
  struct Difference {
    MeanAndWorst all;
    int beyond = 0;
    void add(double difference) {
      all.add(difference);
      beyond += difference > kFrameBound;
    }
  };
  Difference solid, near, paper;  // Measure::refined with both kinds of shadows, Measure::paper
  Difference without_shadows;     // of near, where the places in shadows may count or not
  int counted_in_free_space = 0;  // spheres of solid and near, over all poses
};

// The recordings of `folder` (depth/ with the names below) that are there and that this build can
// read; `poses` random shallow poses on each. Throws what import_cloud throws for damaged ones.
std::vector<FrameResult> run_real_frames(const std::string& folder, const PackedSolid& tool,
                                         std::uint32_t level, int poses, const Device& device);

}  // namespace vpm::bench
