// Reads a depth image from host memory and stores depths on a device.
#pragma once

#include "libvpm/scene/cuda/cloud_prepare.h"

namespace vpm::cuda {

// Points to a depth image as the sensor gives it, counts or metres, in mapped host memory.
struct DepthSource {
  const std::uint16_t* counts = nullptr;
  const float* metres = nullptr;
  double counts_per_metre = 1;
};

// Sets the pixels per thread; images, and arrays made from them, have room for whole groups.
inline constexpr unsigned kPixelsAtOnce = 8;

// Brings the image to the device. Clears the counters, and the coarse tiles for
// denoise_on_device().
void take_image(const DepthSource& source, const CloudRecipe& recipe, CloudCounters* counters,
                cudaStream_t stream);

}  // namespace vpm::cuda
