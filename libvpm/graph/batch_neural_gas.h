// Clustering of spheres by batch neural gas with magnification control: R. Weller, G. Zachmann,
// "Inner Sphere Trees for Proximity and Penetration Queries", RSS 2009.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/model/sphere.h"

namespace vpm {

inline constexpr std::uint32_t kPrototypes = 4;  // the branching factor of the tree

// The prototype (0 .. kPrototypes-1) nearest to each sphere's centre; some may get none. Prototypes
// start at fixed places of the spheres' box and anneal for a fixed number of steps, so the result
// depends on nothing but the spheres and their order.
std::vector<std::uint8_t> batch_neural_gas(std::span<const Sphere> spheres);

}  // namespace vpm
