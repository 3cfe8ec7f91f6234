// Where a mesh keeps from bounding a solid: what messages of make_solid() say of a few places, for
// all of them.
#pragma once

#include <array>
#include <vector>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/model/solid.h"

namespace vpm {

using Segment = std::array<Vec3, 2>;

struct MeshDefects {
  std::vector<std::vector<Segment>> holes;    // the rim of each hole
  std::vector<Segment> non_manifold;          // edges of more than two triangles
  std::vector<Segment> conflicting;           // edges whose two triangles face opposite ways
  std::vector<Vec3> pinched;                  // vertices in which the surface touches itself
  std::vector<std::array<Vec3, 3>> crossing;  // triangles that cut others; none beyond WorkLimit
};

// Returns the triangles as make_solid() sees them before it checks them: cut from polygons, welded
// as `options` say, in metres.
Solid triangles_of(const RawMesh& mesh, const SolidOptions& options);

// Finds the defects of triangles that need bound nothing.
MeshDefects find_defects(const Solid& triangles);

}  // namespace vpm
