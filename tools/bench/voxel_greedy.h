// Greedy sphere placement on a grid of voxels, which packings are compared with.
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

// Places spheres at the voxel centre with the largest clearance, which is the exact distance to the
// mesh. The grid has `voxels` along the longest side; the constructor computes the clearance of
// every voxel once.
class VoxelGreedy {
 public:
  VoxelGreedy(const Solid& solid, int voxels);
  ~VoxelGreedy();
  VoxelGreedy(const VoxelGreedy&) = delete;
  VoxelGreedy& operator=(const VoxelGreedy&) = delete;

  // Returns up to `spheres` spheres, fewer if no voxel centre has room left. They are sorted by
  // size, except refined ones, which come in the order of placement.
  std::vector<Sphere> pack(std::size_t spheres, Refine refine) const;

 private:
  struct Field;
  class Run;
  std::unique_ptr<Field> field_;
};

}  // namespace vpm::bench
