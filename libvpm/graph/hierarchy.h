#pragma once

#include <cstdint>
#include <span>

#include "libvpm/model/tool_model.h"

namespace vpm {

// Returns the wrapped inner-sphere tree: spheres are clustered by batch neural gas down to
// kPrototypes leaves, and each node gets a sphere that encloses the spheres below it. Nodes are
// breadth-first. The depth is O(log spheres), since median splits replace lopsided clusterings.
Hierarchy build_hierarchy(std::span<const Sphere> spheres);

// Returns the number of levels from the root to the deepest node.
std::uint32_t depth(const Hierarchy& hierarchy);

}  // namespace vpm
