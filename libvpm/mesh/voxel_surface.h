// Zero surfaces of sampled fields.
#pragma once

#include "libvpm/model/solid.h"

namespace vpm {

inline constexpr float kVoxelBand = 3;  // voxels; fields are clamped to +-kVoxelBand

// Approximate signed distance from a surface in voxels: negative inside, clamped to +-kVoxelBand.
class VoxelField {
 public:
  VoxelField() = default;
  VoxelField(const VoxelField&) = delete;
  VoxelField& operator=(const VoxelField&) = delete;
  virtual ~VoxelField() = default;

  // Returns the value at x. Thread-safe, as is everywhere().
  virtual float at(Vec3 x) const = 0;

  // Returns +-kVoxelBand if the whole cube with this centre and half edge has that value, or 0 if
  // it must be sampled.
  virtual float everywhere(Vec3 middle, double half_edge) const = 0;
};

struct VoxelBox {
  Vec3 low, high;    // bounds of the surface
  double voxel = 0;  // edge length
};

VoxelBox box_of_mesh(const Solid& mesh, int voxels_along_longest_side);

// Returns a closed, oriented surface; empty if nothing is inside. Identical for any number of
// threads. Throws Error(unavailable) without the library of voxels (voxel_library.h).
Solid voxel_surface(const VoxelField& field, const VoxelBox& box);

}  // namespace vpm
