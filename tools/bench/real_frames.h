// Recorded depth images: the measure beside a brute-force count of the tool's places that lie
// behind the depth of their nearest pixel.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"

namespace vpm::bench {

// The count takes the shadow of an object for its inside, so it is compared where it says less than
// this part of the tool; and also without the places in a shadow: those further behind the surface
// than the tool's reach may count or not.
inline constexpr double kShallow = 0.1;
inline constexpr double kFrameBound = 0.05;  // of the tool

struct FrameResult {
  std::string frame;
  int poses = 0;
  MeanAndWorst difference[2];    // |volume - count| of Measure::refined, Measure::paper
  MeanAndWorst without_shadows;  // of refined, where the places in shadows may count or not
  int beyond = 0, beyond_without_shadows = 0;  // poses of refined with more than kFrameBound
  int counted_in_free_space = 0;               // spheres of refined, over all poses
};

// The recordings of `folder` (depth/ with the names below) that are there and that this build can
// read; `poses` random shallow poses on each. Throws what import_cloud throws for damaged ones.
std::vector<FrameResult> run_real_frames(const std::string& folder, const PackedSolid& tool,
                                         std::uint32_t level, int poses);

}  // namespace vpm::bench
