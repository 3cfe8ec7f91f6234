// Tools that cross silhouettes and holes of an image: the volume must not jump, and nothing may
// count where the camera saw free space.
#pragma once

#include <string>
#include <vector>

#include "libvpm/query/tool_query.h"
#include "tools/bench/penetration_case.h"

namespace vpm::bench {

struct SilhouetteResult {
  std::string path;
  double volume_worst[2] = {}, jump_worst[2] = {};  // indexed by Measure::refined, Measure::paper
  // Worst difference of Shadows::solid from the count of places behind the image, and its
  // worst step between neighbouring poses beyond the count's step; 0 for images with missing
  // pixels.
  double solid_worst = 0, solid_jump_worst = 0;
  int counted_in_free_space = 0;  // in `refined` with both kinds of occluded space, over all poses
};

// Counts the spheres that are inside although their cell lies wholly in front of every pixel in its
// direction. Looks at each of these pixels.
int counted_in_free_space(const ToolModel& tool, const Level& level, const Pose& pose,
                          const DepthImage& depth, const Camera& camera,
                          std::span<const SphereState> states);

// Moves the tool across the edges of a block in front of a wall, and over a wall whose image lacks
// pixels: single ones at random, and round holes.
std::vector<SilhouetteResult> run_silhouettes(const PackedSolid& tool, std::uint32_t level,
                                              int poses, const Device& device);

}  // namespace vpm::bench
