// Orders points so that the leaves of a tree of boxes are compact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

// Rearranges `order`, indices of points in a total order, for the leaves of a PointTree: each node
// is split across the longest side of its box so that its first half is full. Equal coordinates,
// and points in a leaf, keep the given order.
void order_by_leaves(std::span<const Vec3f> points, std::vector<std::uint32_t>& order);

}  // namespace vpm
