// Normals of an image on a device: those of estimate_normals(), bit by bit.
#pragma once

#include "libvpm/cloud/normals.h"
#include "libvpm/surface/cuda/cloud_tile.h"

namespace vpm::cuda {

// What the current device can do with windows of this size.
struct NormalsPlan {
  bool fits = false;      // its shared memory holds them
  bool overlaps = false;  // kernels may be launched before those before them are done
};
NormalsPlan plan_normals(const NormalOptions& options);

// Of all pixels, in camera axes; 0 where there is none. After take_image() in the same stream.
void estimate_on_device(const CloudRecipe& recipe, NormalMethod method, const NormalsPlan& plan,
                        Vec3f* normals, cudaStream_t stream);

}  // namespace vpm::cuda
