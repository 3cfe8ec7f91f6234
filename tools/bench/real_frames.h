// Recorded depth images: the measure beside a brute-force count of the tool's places that lie
// behind the depth of their nearest pixel.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/penetration_case.h"
#include "tools/bench/statistics.h"

namespace vpm::bench {

// The count takes the shadow of an object for its inside, so it is compared where it says less than
// this part of the tool.
inline constexpr double kShallow = 0.1;

struct FrameResult {
  std::string frame;
  int poses = 0;
  MeanAndWorst difference[2];     // |volume - count| of Measure::refined, Measure::paper
  int counted_in_free_space = 0;  // spheres of refined, over all poses
};

// The recordings of `folder` (depth/ with the names below) that are there and that this build can
// read; `poses` random shallow poses on each. Throws what import_cloud throws for damaged ones.
std::vector<FrameResult> run_real_frames(const std::string& folder, const PackedSolid& tool,
                                         std::uint32_t level, int poses);

}  // namespace vpm::bench
