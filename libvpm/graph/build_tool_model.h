// Makes the model that queries load from a packing.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "libvpm/graph/shares.h"
#include "libvpm/model/packing.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Size of the cell samples: this many fit along cbrt(volume), so that a level has about 64 samples
// per sphere, up to those of 1000 spheres: beyond, samples of the spheres' own size follow anyway.
// A level of few spheres thus costs little, and its error is that of its own size: the volume that
// a plane or a ball cuts off is within 0.03 % of the solid's with 1000 spheres; up to 0.2 % for a
// plane within a sample's size of a parallel face, because the samples are balls that smooth the
// face.
double samples_per_length(std::uint32_t spheres);
inline constexpr double kMostSamplesPerLength = 32, kLeastSamplesPerLength = 6;

struct GraphOptions {
  double epsilon = 0;                 // m; 0 takes a tenth of each level's smallest radius
  std::vector<std::uint32_t> levels;  // sphere counts, any order; the full packing always is one
  std::function<void(double fraction)> progress;
};

// Fills every level from the largest spheres and the solid of the packing. `quality`, if given,
// receives one entry per level. Errors: usage for options that mean nothing, refused for a packing
// that is none. Same bytes for any thread count; a power of two on all coordinates changes
// exponents only.
ToolModel build_tool_model(const Packing& packing, const GraphOptions& options,
                           std::vector<ShareQuality>* quality = nullptr);

}  // namespace vpm
