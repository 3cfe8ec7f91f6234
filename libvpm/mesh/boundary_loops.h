// Rims of the holes in an open mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/mesh/topology.h"
#include "libvpm/model/solid.h"

namespace vpm {

struct BoundaryLoop {
  // In the order of a face that would close the hole, if the triangles around it are consistently
  // oriented.
  std::vector<std::uint32_t> vertices;
  bool closed = true;  // false if the rim ends at an edge of more than two triangles
};

// Returns the loops, longest first, then by lower first vertex. A vertex where two holes touch is
// in both loops.
std::vector<BoundaryLoop> boundary_loops(const Topology& topology,
                                         const std::vector<Triangle>& triangles);

// Returns the diameter of a ball that can pass through a nearly flat and convex hole: the rim's
// narrowest extent across one of its edges, in its mean plane. An upper bound for other rims.
double width_of(const BoundaryLoop& loop, const std::vector<Vec3>& vertices);

}  // namespace vpm
