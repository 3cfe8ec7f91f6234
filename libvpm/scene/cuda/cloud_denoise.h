// Denoises the image that prepare_on_device() made and builds its pyramid, with the bits of
// denoised_image.h and inverse_depth_pyramid.h.
#pragma once

#include "libvpm/scene/cuda/cloud_tile.h"

namespace vpm::cuda {

// Launches after prepare_on_device() in the same stream. `overlaps` is Preparation::overlaps.
void denoise_on_device(const CloudRecipe& recipe, bool overlaps, cudaStream_t stream);

}  // namespace vpm::cuda
