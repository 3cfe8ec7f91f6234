#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/model/sphere.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Returns the wrapped inner-sphere tree: spheres are clustered by batch neural gas down to
// kPrototypes leaves, and each node gets a sphere that encloses the spheres below it. Nodes are
// breadth-first. The depth is O(log spheres), since median splits replace lopsided clusterings.
Hierarchy build_hierarchy(std::span<const Sphere> spheres);

// Returns the number of levels from the root to the deepest node.
std::uint32_t depth(const Hierarchy& hierarchy);

inline constexpr std::uint32_t kPrototypes = 4;  // branching factor of the tree

// Clusters spheres by batch neural gas with magnification control (R. Weller, G. Zachmann, "Inner
// Sphere Trees for Proximity and Penetration Queries", RSS 2009). Returns for each sphere the
// prototype, 0 to kPrototypes - 1, nearest to its centre; some prototypes may get no sphere.
// Prototypes start at fixed places of the bounding box and anneal for a fixed number of steps, so
// the result depends only on the spheres and their order.
std::vector<std::uint8_t> batch_neural_gas(std::span<const Sphere> spheres);

}  // namespace vpm
