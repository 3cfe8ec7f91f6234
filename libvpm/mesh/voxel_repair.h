// Rebuilds the solid of a damaged mesh from voxels.
//
// Two definitions of inside: by winding number, which open, non-manifold and self-intersecting
// meshes have too (Jacobson, Kavan, Sorkine-Hornung 2013, "Robust inside-outside segmentation using
// generalized winding numbers"); or by a flood from outside, for which everything that a ball of a
// given width cannot reach is inside, however triangles face.
#pragma once

#include <vpm/solid.h>

#include "libvpm/model/solid.h"

namespace vpm {

// Limits of the number of voxels along the longest side of the mesh's bounding box.
inline constexpr int kMinRepairVoxels = 8, kMaxRepairVoxels = 1024;
// Least width of a flood's ball in voxels; smaller ones would slip through the lattice.
inline constexpr double kNarrowestFlood = 2;

struct VoxelRepair {
  double voxel = 0;     // edge length, m
  double max_hole = 0;  // m; no wider hole was closed; 0: no limit
  // Largest distances between the surfaces, m, sampled at half a voxel: from the solid to the mesh
  // (large where a hole was closed), and from the mesh to the solid (large where a part that
  // encloses nothing was dropped). Their maximum is the Hausdorff distance.
  double solid_to_mesh = 0, mesh_to_solid = 0;
};

// Turns triangles to agree with their neighbours, and all of them if they enclose a negative
// volume. Returns false for a one-sided surface, which has no winding number.
bool orient_outward(Solid& mesh);

// The repairs return a closed, oriented surface made by OpenVDB, empty if no voxel lies inside.
// Details below a voxel vanish. Lengths in the mesh's unit. Identical for any number of threads.
// Throw Error(invalid_argument) for a resolution or width out of range.

// Takes as inside what has a generalised winding number above one half; most triangles must face
// outward.
Solid repair_by_winding_number(const Solid& mesh, int voxels, VoxelRepair& done);

// Takes as inside what no ball of this width reaches that comes from outside and touches no
// triangle. Closes narrower holes and gaps, fills cavities, and rounds creases as the ball does.
Solid repair_by_flood(const Solid& mesh, int voxels, double width, VoxelRepair& done);

}  // namespace vpm
