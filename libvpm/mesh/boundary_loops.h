// The rims of the holes in an open mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/mesh/topology.h"
#include "libvpm/model/solid.h"

namespace vpm {

struct BoundaryLoop {
  // In the order in which a face that closes the hole would list them, if the triangles around it
  // are consistently oriented.
  std::vector<std::uint32_t> vertices;
  bool closed = true;  // false where the rim ends at an edge of more than two triangles
};

// Longest first; of equally long ones the one with the lower first vertex. A vertex that two holes
// touch is in the loops of both.
std::vector<BoundaryLoop> boundary_loops(const Topology& topology,
                                         const std::vector<Triangle>& triangles);

// How wide a ball may be that passes through the hole, for a rim that is nearly flat and convex:
// the rim's narrowest extent across one of its edges, in its mean plane. More for rims that are
// neither.
double width_of(const BoundaryLoop& loop, const std::vector<Vec3>& vertices);

}  // namespace vpm
