// Normals of an image on a device: those of estimate_normals(), bit by bit.
#pragma once

#include "libvpm/cloud/normals.h"
#include "libvpm/surface/cuda/cloud_tile.h"

namespace vpm::cuda {

// Windows that are not smooth: listed by the kernel that finds them, fitted by another, so that all
// of the device takes part wherever in the image they are. Room for a list of all pixels.
struct GatedList {
  std::uint32_t* pixels = nullptr;
  unsigned* count = nullptr;  // 0 between launches
  unsigned* done = nullptr;   // blocks of a launch; 0 between launches
};

// What the current device can do with windows of this size.
struct NormalsPlan {
  bool fits = false;          // its shared memory holds them
  bool overlaps = false;      // kernels may be launched before those before them are done
  unsigned gated_blocks = 0;  // that it has room for
};
NormalsPlan plan_normals(const NormalOptions& options);

// Of all pixels, in camera axes; 0 where there is none. After take_image() in the same stream.
void estimate_on_device(const CloudRecipe& recipe, NormalMethod method, const NormalsPlan& plan,
                        const GatedList& gated, Vec3f* normals, cudaStream_t stream);

}  // namespace vpm::cuda
