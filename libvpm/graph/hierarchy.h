#pragma once

#include <cstdint>
#include <span>

#include "libvpm/model/tool_model.h"

namespace vpm {

// Wrapped inner-sphere tree: clusters of spheres by batch neural gas down to kPrototypes leaves,
// each node wrapped in a sphere that encloses the spheres below it. Breadth-first; the depth is
// bounded by O(log spheres) because a lopsided clustering is replaced by median splits.
Hierarchy build_hierarchy(std::span<const Sphere> spheres);

// Levels of nodes from the root to the deepest one.
std::uint32_t depth(const Hierarchy& hierarchy);

}  // namespace vpm
