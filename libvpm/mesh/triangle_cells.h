// Cuts a triangle along segments into convex cells that no segment crosses.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/mesh/predicates.h"

namespace vpm {

// Points of the triangle a, b, c are (x, y) for a + x (b - a) + y (c - a).
struct TriangleSegment {
  Vec2 from, to;
};

// The cells of 0 <= x, 0 <= y, x + y <= 1, each a convex polygon that turns counter-clockwise.
// Segments may reach beyond the triangle; what is shorter than 1e-12 is left out. A binary space
// partition: a segment cuts no cell that it does not enter.
std::vector<std::vector<Vec2>> triangle_cells(const std::vector<TriangleSegment>& segments);

}  // namespace vpm
