// Pairs of triangles of one mesh that cut or touch each other beyond the vertices and edges they
// share.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

// Two triangles, the lower index first.
using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

// Ascending. Decided by exact predicates. Triangles without area are left out. A group of a few
// triangles stops at 100 partners each, so that a mesh of coinciding triangles costs no quadratic
// memory.
std::vector<TrianglePair> find_self_intersections(const std::vector<Vec3>& vertices,
                                                  const std::vector<Triangle>& triangles);

// Parts that were made to meet are a rounding apart: what is nearer than this, in metres, touches.
double contact_tolerance(const std::vector<Vec3>& vertices);

// These, and pairs that overlap in one plane as far as the tolerance tells.
std::vector<TrianglePair> find_contacts(const std::vector<Vec3>& vertices,
                                        const std::vector<Triangle>& triangles);

}  // namespace vpm
