// Pairs of triangles of one mesh that cut or touch each other beyond the vertices and edges they
// share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

struct SelfIntersections {
  std::size_t pairs = 0;
  // The first triangles, ascending, that meet a later one; at most kListed.
  static constexpr std::size_t kListed = 8;
  std::vector<std::uint32_t> first_triangles;
};

// Decided by exact predicates. Triangles without area are left out. A group of a few triangles
// stops at 100 partners each, so that a mesh of coinciding triangles costs no quadratic memory.
SelfIntersections find_self_intersections(const std::vector<Vec3>& vertices,
                                          const std::vector<Triangle>& triangles);

}  // namespace vpm
