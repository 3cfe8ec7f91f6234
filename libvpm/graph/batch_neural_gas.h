// Clustering of spheres by batch neural gas with magnification control (R. Weller, G. Zachmann,
// "Inner Sphere Trees for Proximity and Penetration Queries", RSS 2009).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/model/sphere.h"

namespace vpm {

inline constexpr std::uint32_t kPrototypes = 4;  // branching factor of the tree

// Returns for each sphere the prototype, 0 to kPrototypes - 1, nearest to its centre; some
// prototypes may get no sphere. Prototypes start at fixed places of the bounding box and anneal for
// a fixed number of steps, so the result depends only on the spheres and their order.
std::vector<std::uint8_t> batch_neural_gas(std::span<const Sphere> spheres);

}  // namespace vpm
