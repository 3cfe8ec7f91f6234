// The order of points in which the leaves of a tree of boxes are compact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

// `order`: indices of points, in a total order. Rearranges them for the leaves of a PointTree: the
// points of each node are parted across the longest side of their box, so that the first half is
// full. Of equal coordinates, and in a leaf, the order is that given.
void order_by_leaves(std::span<const Vec3f> points, std::vector<std::uint32_t>& order);

}  // namespace vpm
