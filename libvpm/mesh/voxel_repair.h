// The solid that a damaged mesh stands for, by voxels.
//
// By winding number: open, non-manifold and self-intersecting meshes have winding numbers too
// (Jacobson, Kavan, Sorkine-Hornung 2013, "Robust inside-outside segmentation using generalized
// winding numbers"). By a flood from outside: what a ball of a given width cannot reach is inside,
// whichever way the triangles face.
#pragma once

#include "libvpm/model/solid.h"

namespace vpm {

// Voxels along the longest side of the mesh's box.
inline constexpr int kRepairVoxels = 128, kFewestRepairVoxels = 8, kMostRepairVoxels = 1024;
// A flood's ball must be this many voxels wide, or it slips through the lattice.
inline constexpr double kNarrowestFlood = 2;

struct VoxelRepair {
  double voxel = 0;     // edge length, m
  double max_hole = 0;  // m: no wider hole was closed; 0: no bound
  // Largest distances between the surfaces, sampled at half a voxel: from the solid to the mesh
  // (large where a hole was closed) and from the mesh to the solid (large where something that
  // encloses nothing was dropped). Their maximum is the Hausdorff distance.
  double solid_to_mesh = 0, mesh_to_solid = 0;
};

// Turns triangles to agree with their neighbours, and all of them if they enclose a negative
// volume; false for a one-sided surface, which has no winding number.
bool orient_outward(Solid& mesh);

// Both give a closed, oriented surface, by OpenVDB; empty where no voxel lies inside. Details below
// a voxel vanish. Identical for any number of threads. Throw Error(usage) for a resolution, or a
// width, out of range. Lengths are the mesh's.

// Inside is where the generalised winding number is above one half; most triangles must face
// outward.
Solid repair_by_winding_number(const Solid& mesh, int voxels, VoxelRepair& done);

// Inside is what no ball of this width reaches that comes from outside and touches no triangle.
// Holes and gaps that are narrower are closed, cavities filled; creases are rounded as by the ball.
Solid repair_by_flood(const Solid& mesh, int voxels, double width, VoxelRepair& done);

}  // namespace vpm
