// A second opinion on a packing that shares nothing with the packer: OpenVDB voxelises the mesh,
// and voxel centres are counted.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Voxels along the longest side of the solid's box.
inline constexpr int kValidationVoxels = 256;

struct Validation {
  double voxel = 0;        // edge length, m
  double volume_mesh = 0;  // m^3, voxels whose centres lie inside
  double coverage = 0;     // volume of the union of the spheres within the solid / volume_mesh
  // Three standard errors of the coverage, each voxel cut by a surface taken as a coin of its own,
  // and the voxels near the mesh whose side OpenVDB and the winding number do not agree on: OpenVDB
  // fills gaps narrower than three voxels, and voids that nothing but a surface crossing itself
  // closes off.
  double coverage_error = 0;
  double max_protrusion = 0;  // m: how far outside the farthest voxel centre in a sphere lies
  double max_overlap = 0;     // m: r_i + r_j - |c_i - c_j| of spheres that share a voxel centre
  std::size_t protruding_voxels = 0, overlapping_voxels = 0;
  std::size_t disputed_voxels = 0;  // inside by OpenVDB or by the winding number, but not by both
  // m: a protrusion or an overlap deeper than this holds a voxel centre and cannot be missed
  // (a depth d leaves room for a ball of diameter d; no ball wider than a voxel's diagonal
  // misses the centres).
  double detection_limit = 0;
};

// Protrusions are measured up to 3 voxels. Throws Error(refused) for a solid without extent.
Validation validate_packing(const Solid& solid, const std::vector<Sphere>& spheres,
                            int voxels = kValidationVoxels);

}  // namespace vpm
