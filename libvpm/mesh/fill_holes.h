// Closes holes of a mesh with triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/mesh/boundary_loops.h"

namespace vpm {

// A hole is filled if its rim lies in a plane, or if it is small: then no surface that the mesh
// could have had there is far away. Shares of the rim's size and of the mesh's, both diagonals of
// boxes.
inline constexpr double kPlanarRim = 1e-3;
inline constexpr double kSmallHole = 0.2;

struct FilledHole {
  std::size_t edges = 0;
  Vec3 center;      // mean of the rim's vertices
  double size = 0;  // diagonal of the rim's box
  bool planar = false;
};

struct HoleFilling {
  std::vector<FilledHole> filled;
  std::vector<BoundaryLoop> left;  // neither planar nor small, or not closed
};

// Appends triangles, and vertices where a rim has no triangulation of its own. The triangulation
// has the least area (Barequet, Sharir 1995, "Filling gaps in the boundary of a polyhedron"), and
// uses no edge that the mesh has; rims of more than 1000 edges become a fan about their middle.
// The triangles given must be consistently oriented. `diagonal` is that of the mesh's box.
HoleFilling fill_holes(const Topology& topology, double diagonal, std::vector<Vec3>& vertices,
                       std::vector<Triangle>& triangles);

}  // namespace vpm
