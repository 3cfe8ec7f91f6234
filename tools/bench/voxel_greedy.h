// What a packer is compared with: greedy placement on a grid of voxels.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm::bench {

enum class Refine {
  none,           // spheres stay on voxel centres
  local_maximum,  // centres move to the local maximum of the exact clearance, by compass search
};

// Places spheres about the voxel centre with the largest clearance, exact distances to the mesh,
// `voxels` along the longest side. The room of every voxel is measured once, on construction.
class VoxelGreedy {
 public:
  VoxelGreedy(const Solid& solid, int voxels);
  ~VoxelGreedy();
  VoxelGreedy(const VoxelGreedy&) = delete;
  VoxelGreedy& operator=(const VoxelGreedy&) = delete;

  // Up to `spheres` spheres; fewer where no voxel centre has room. Largest first but for refined
  // ones, which come as they were placed.
  std::vector<Sphere> pack(std::size_t spheres, Refine refine) const;

 private:
  struct Field;
  class Run;
  std::unique_ptr<Field> field_;
};

}  // namespace vpm::bench
