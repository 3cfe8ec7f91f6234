// From a depth image in the host's memory to depths on a device.
#pragma once

#include "libvpm/scene/cuda/cloud_prepare.h"

namespace vpm::cuda {

// A depth image as the sensor gives it, counts or metres, in memory of the host that the device
// reads over the bus.
struct DepthSource {
  const std::uint16_t* counts = nullptr;
  const float* metres = nullptr;
  double counts_per_metre = 1;
};

// A thread takes so many pixels; images, and what is made of them, have room for whole groups.
inline constexpr unsigned kPixelsAtOnce = 8;

// Brings the image to the device. Clears the counters, and the coarse tiles, which
// denoise_on_device() (cloud_denoise.h) adds to.
void take_image(const DepthSource& source, const CloudRecipe& recipe, CloudCounters* counters,
                cudaStream_t stream);

}  // namespace vpm::cuda
