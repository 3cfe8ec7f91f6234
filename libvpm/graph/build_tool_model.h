// Builds the model that queries load from a packing.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "libvpm/graph/voronoi_cells.h"
#include "libvpm/model/packing.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Returns the number of samples along cbrt(volume), which sets their size: about 64 samples per
// sphere up to 1000 spheres, beyond which spheres are as small as samples. Levels of few spheres
// thus cost little, and their error matches their size: the volume that a plane or a ball cuts off
// is within 0.03 % of the solid's with 1000 spheres. It is up to 0.2 % for a plane within a
// sample's size of a parallel face, since samples are balls and blur the face.
double samples_per_length(std::uint32_t spheres);
inline constexpr double kMaxSamplesPerLength = 32, kMinSamplesPerLength = 6;

struct GraphOptions {
  double epsilon = 0;  // in metres; 0 takes a tenth of each level's smallest radius
  // Sphere counts in any order; the full packing is always added.
  std::vector<std::uint32_t> levels;
  // Keeps the boundary of what the solid encloses (ToolModel::surface), where its pieces close.
  bool surface = true;
  std::function<void(double fraction)> progress;
};

// Builds each level from the largest spheres and the solid of the packing; metres. `quality`,
// unless null, receives one entry per level. Throws Error(invalid_argument) for senseless options,
// Error(refused) for a bad packing. Same bytes for any thread count; scaling all coordinates by a
// power of two changes exponents only.
ToolModel build_tool_model(const Packing& packing, const GraphOptions& options,
                           std::vector<VoronoiQuality>* quality = nullptr);

}  // namespace vpm
