// From a depth image in the host's memory to depths on a device, of all of it or of a part.
#pragma once

#include "libvpm/surface/cuda/cloud_prepare.h"

namespace vpm::cuda {

// A depth image as the sensor gives it, counts or metres, in memory of the host that the device
// reads over the bus.
struct DepthSource {
  const std::uint16_t* counts = nullptr;
  const float* metres = nullptr;
  double counts_per_metre = 1;
};

// Pixels that one thread takes; images and what is made of them have room for the last thread's.
inline constexpr unsigned kPixelsAtOnce = 8;

// Brings the part of the image that the normals of `wanted` are made of to the device, but for what
// those of `made` were made of: depths and their inverses, as recipes want them. With the first
// part of an image it clears what settle_on_device() (cloud_settle.h) adds up, and the counters.
void take_image(const DepthSource& source, float* depth, float* inverse, const CloudRecipe& recipe,
                const PixelRectangle& wanted, const PixelRectangle& made, CloudCounters* counters,
                cudaStream_t stream);

}  // namespace vpm::cuda
