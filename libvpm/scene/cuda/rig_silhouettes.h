// Spreads the silhouettes of a rig's images on a device, and the fits of their holes: what
// ImageSilhouettes::spread() does, with its bits, for all images at once.
#pragma once

#include "libvpm/device/cuda/runtime.h"
#include "libvpm/scene/rig/rig_sampler.h"

namespace vpm::cuda {

// Points to an image's silhouettes in the memory of a device.
struct SpreadImage {
  const SilhouettePixel* pixels = nullptr;  // given, as what has no number beside it
  const NumberedPixel* holes = nullptr;     // pixels with a fit, and its number
  std::uint32_t pixel_count = 0, hole_count = 0;
  std::uint32_t* numbers = nullptr;  // room: by pixel, one more than the index of its silhouette
  std::int8_t* down = nullptr;       // room: rows from a pixel to the nearest one of its column
  // Silhouettes and HoleFits describe these; `hole_numbers` is null without fits.
  std::uint32_t *nearest = nullptr, *hole_numbers = nullptr, *sums = nullptr;
  std::int32_t width = 0, height = 0, columns = 0, rows = 0;  // of the image and of the sums
  SilhouetteKeys keys{1};
};

struct SpreadImages {
  SpreadImage of[RigSampler::kMostCameras];
  unsigned count = 0;
};

void spread_on_device(const SpreadImages& images, cudaStream_t stream);

}  // namespace vpm::cuda
