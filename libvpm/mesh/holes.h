// Holes of an open mesh: their rims, and triangles that close them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/mesh/topology.h"
#include "libvpm/model/solid.h"

namespace vpm {

// Rim of a hole.
struct BoundaryLoop {
  // Vertices of the rim, in the order of a face that would close the hole if the triangles around
  // it are consistently oriented.
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

// Largest deviation of a rim from a plane, relative to its size, and largest size of a rim,
// relative to the mesh's; sizes are diagonals of bounding boxes. A hole within either limit is
// filled: any surface that the mesh could have had there is near.
inline constexpr double kPlanarRim = 1e-3;
inline constexpr double kSmallHole = 0.2;

struct FilledHole {
  std::size_t edges = 0;
  Vec3 center;      // mean of the rim's vertices
  double size = 0;  // diagonal of the rim's bounding box
  bool planar = false;
};

struct HoleFilling {
  std::vector<FilledHole> filled;
  std::vector<BoundaryLoop> left;  // neither planar nor small, or not closed
};

// Appends triangles, and a vertex where a rim has no triangulation of its own. Triangulations have
// the least area (Barequet, Sharir 1995, "Filling gaps in the boundary of a polyhedron") and use no
// edge of the mesh; rims of more than 1000 edges become a fan about their middle. The given
// triangles must be consistently oriented; `diagonal` is that of the mesh's bounding box.
HoleFilling fill_holes(const Topology& topology, double diagonal, std::vector<Vec3>& vertices,
                       std::vector<Triangle>& triangles);

}  // namespace vpm
