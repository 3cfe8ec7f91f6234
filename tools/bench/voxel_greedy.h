// What a packer is compared with: greedy placement on a grid of voxels.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm::bench {

enum class Refine {
  none,           // spheres stay on voxel centres
  local_maximum,  // centres move to the local maximum of the exact clearance, by compass search
};

// Up to `spheres` spheres: always about the voxel centre with the largest clearance, exact
// distances to the mesh, `voxels` along the longest side. Ends early where no voxel centre has
// room. Largest first but for refined ones, which come as they were placed.
std::vector<Sphere> pack_on_voxels(const Solid& solid, std::size_t spheres, int voxels,
                                   Refine refine);

}  // namespace vpm::bench
