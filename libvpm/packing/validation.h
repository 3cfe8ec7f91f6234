// Independent check of a packing that shares no code with the packer: OpenVDB voxelises the mesh,
// and voxel centres are counted.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Number of voxels along the longest side of the solid's bounding box.
inline constexpr int kValidationVoxels = 256;

struct Validation {
  double voxel = 0;        // edge length, m
  double volume_mesh = 0;  // volume of voxels with centres inside, m^3
  // Volume of the union of the spheres inside the solid / volume_mesh.
  double coverage = 0;
  // Three standard errors of the coverage, taking each voxel cut by a surface as independent, plus
  // the disputed voxels. OpenVDB fills gaps narrower than three voxels, and voids that only a
  // self-crossing of the surface closes.
  double coverage_error = 0;
  double max_protrusion = 0;  // m; how far outside the farthest voxel centre in a sphere lies
  double max_overlap = 0;     // m; r_i + r_j - |c_i - c_j| of spheres that share a voxel centre
  std::size_t protruding_voxels = 0, overlapping_voxels = 0;
  // Voxels inside by OpenVDB or by the winding number, but not by both.
  std::size_t disputed_voxels = 0;
  // m; deeper protrusions and overlaps hold a voxel centre and cannot be missed. A depth d leaves
  // room for a ball of diameter d, and no ball wider than a voxel's diagonal misses all centres.
  double detection_limit = 0;
};

// Validates a packing; protrusions are measured up to 3 voxels. Throws Error(refused) for a solid
// without extent, Error(unavailable) without the library of voxels (mesh/voxel_library.h).
Validation validate_packing(const Solid& solid, const std::vector<Sphere>& spheres,
                            int voxels = kValidationVoxels);

}  // namespace vpm
