// Surfaces where a sampled field is zero, by OpenVDB.
#pragma once

#include "libvpm/model/solid.h"

namespace vpm {

inline constexpr float kVoxelBand = 3;  // voxels; values of fields are cut off there

// About the signed distance from a surface, in voxels: negative inside, within -kVoxelBand and
// kVoxelBand.
class VoxelField {
 public:
  VoxelField() = default;
  VoxelField(const VoxelField&) = delete;
  VoxelField& operator=(const VoxelField&) = delete;
  virtual ~VoxelField() = default;

  // Thread-safe, like the other.
  virtual float at(Vec3 x) const = 0;

  // +kVoxelBand or -kVoxelBand where all of the cube with this middle and half edge has that value,
  // 0 where it must be looked at.
  virtual float everywhere(Vec3 middle, double half_edge) const = 0;
};

struct VoxelBox {
  Vec3 low, high;    // what the surface lies in
  double voxel = 0;  // edge length
};

VoxelBox box_of_mesh(const Solid& mesh, int voxels_along_longest_side);

// A closed, oriented surface; empty where nothing is inside. Identical for any number of threads.
Solid voxel_surface(const VoxelField& field, const VoxelBox& box);

}  // namespace vpm
