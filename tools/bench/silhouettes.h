// Edges and holes of an image: a tool that crosses a silhouette or a hole must neither jump nor be
// counted where the camera saw free space.
#pragma once

#include <string>
#include <vector>

#include "libvpm/query/tool_query.h"
#include "tools/bench/penetration_case.h"

namespace vpm::bench {

struct SilhouetteResult {
  std::string path;
  double volume_worst[2] = {}, jump_worst[2] = {};  // of Measure::refined, Measure::paper
  // Of Shadows::solid, beside the count of what is behind the image: difference, and how much the
  // volume moves between neighbouring poses beyond what the count does; 0 of images that lack
  // pixels.
  double solid_worst = 0, solid_jump_worst = 0;
  int counted_in_free_space = 0;  // spheres of refined with both kinds of shadows, over all poses
};

// Spheres that count although their share lies wholly before what every pixel in its direction
// measured: found by looking at each of these pixels.
int counted_in_free_space(const ToolModel& tool, const Level& level, const Pose& pose,
                          const DepthImage& depth, const Camera& camera,
                          std::span<const SphereState> states);

// The tool across the edges of a block that stands before a wall, and over a wall whose image lacks
// pixels: single ones at random, and round patches.
std::vector<SilhouetteResult> run_silhouettes(const PackedSolid& tool, std::uint32_t level,
                                              int poses, const Device& device);

}  // namespace vpm::bench
