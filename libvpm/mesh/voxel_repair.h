// The solid that a damaged mesh stands for, by voxels: open, non-manifold and self-intersecting
// meshes have winding numbers too (Jacobson, Kavan, Sorkine-Hornung 2013, "Robust inside-outside
// segmentation using generalized winding numbers").
#pragma once

#include "libvpm/model/solid.h"

namespace vpm {

// Voxels along the longest side of the mesh's box.
inline constexpr int kRepairVoxels = 128, kFewestRepairVoxels = 8, kMostRepairVoxels = 1024;

struct VoxelRepair {
  double voxel = 0;  // edge length, m
  // Largest distances between the surfaces, sampled at half a voxel: from the solid to the mesh
  // (large where a hole was closed) and from the mesh to the solid (large where something that
  // encloses nothing was dropped). Their maximum is the Hausdorff distance.
  double solid_to_mesh = 0, mesh_to_solid = 0;
};

// A closed, oriented surface, by OpenVDB; empty where no voxel lies inside. Inside is where the
// generalised winding number is above one half. Most triangles must face outward, or inward; the
// mesh is turned if it encloses a negative volume. Details below a voxel vanish. Identical for any
// number of threads. Throws Error(usage) for a resolution out of range.
Solid repair_by_voxels(const Solid& mesh, int voxels, VoxelRepair& done);

}  // namespace vpm
