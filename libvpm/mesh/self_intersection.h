// Pairs of triangles of one mesh that intersect beyond the vertices and edges they share.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

// Two triangles, the lower index first.
using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

// Returns the pairs in ascending order, found by exact predicates; triangles without area are left
// out. A group of a few triangles stops at 100 partners each, so that coinciding triangles need no
// quadratic memory.
std::vector<TrianglePair> find_self_intersections(const std::vector<Vec3>& vertices,
                                                  const std::vector<Triangle>& triangles);

// Returns the distance, m, below which parts touch: those made to meet are off by rounding.
double contact_tolerance(const std::vector<Vec3>& vertices);

// Returns self-intersections, and pairs that overlap in a common plane within the tolerance.
std::vector<TrianglePair> find_contacts(const std::vector<Vec3>& vertices,
                                        const std::vector<Triangle>& triangles);

}  // namespace vpm
