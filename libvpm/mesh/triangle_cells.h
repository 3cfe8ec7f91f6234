// Cuts a triangle along segments into convex cells that no segment crosses.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/mesh/predicates.h"

namespace vpm {

// Segment in the coordinates of a triangle a, b, c: (x, y) is a + x (b - a) + y (c - a).
struct TriangleSegment {
  Vec2 from, to;
};

// Returns the cells of 0 <= x, 0 <= y, x + y <= 1 as convex counter-clockwise polygons. Segments
// may extend beyond the triangle; parts shorter than 1e-12 are ignored. Uses a binary space
// partition, so a segment cuts only cells that it enters. Adds its work to `work`, and returns
// nothing as soon as that is more than `most_work`.
std::vector<std::vector<Vec2>> triangle_cells(const std::vector<TriangleSegment>& segments,
                                              std::uint64_t most_work, std::uint64_t& work);

}  // namespace vpm
