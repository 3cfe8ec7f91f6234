// The surface that queries read, from what prepare_on_device() has found: denoised_image.h and
// inverse_depth_pyramid.h on a device, with their bits.
#pragma once

#include "libvpm/scene/cuda/cloud_tile.h"

namespace vpm::cuda {

// After prepare_on_device() in the same stream. `overlaps`: as there.
void denoise_on_device(const CloudRecipe& recipe, bool overlaps, cudaStream_t stream);

}  // namespace vpm::cuda
