// Makes a cloud and its surface from a depth image in host memory by three kernels, with the bits
// of make_cloud() and denoised_image.h: takes the image to the device, makes points with normals
// and the image without holes, denoises that and builds its pyramid.
#pragma once

#include "libvpm/cloud/normals.h"
#include "libvpm/device/cuda/numbered_word.h"
#include "libvpm/scene/cuda/cloud_tile.h"

namespace vpm::cuda {

// Points to a depth image as the sensor gives it, counts or metres, in mapped host memory.
struct DepthSource {
  const std::uint16_t* counts = nullptr;
  const float* metres = nullptr;
  double counts_per_metre = 1;
};

// Pixels per thread; images, and arrays made from them, have room for whole groups.
inline constexpr unsigned kPixelsAtOnce = 8;

// Holds the results of an image's preparation, in memory that the host reads.
struct CloudAnswer {
  NumberedWord points = 0;    // number of points with a normal
  NumberedWord doubtful = 0;  // not 0: there are points that a PreparedImage might refuse
};

struct CloudCounters {
  unsigned points = 0, doubtful = 0;
  unsigned done = 0;  // finished blocks of a launch; 0 between launches
};

// Tells what the current device can do with windows of this size.
struct Preparation {
  bool fits = false;      // shared memory holds them
  bool overlaps = false;  // the kernel may be launched before take_image() ends
};
Preparation preparation_of(const NormalOptions& options);

// Brings the image to the device. Clears the counters, and the coarse tiles for
// denoise_on_device().
void take_image(const DepthSource& source, const CloudRecipe& recipe, CloudCounters* counters,
                cudaStream_t stream);

// Launches after take_image() in the same stream. The answer comes when the last normal is known.
void prepare_on_device(const CloudRecipe& recipe, NormalMethod method,
                       const Preparation& preparation, CloudCounters* counters, CloudAnswer* answer,
                       unsigned sequence, cudaStream_t stream);

// Launches after prepare_on_device() in the same stream. `overlaps` is Preparation::overlaps.
void denoise_on_device(const CloudRecipe& recipe, bool overlaps, cudaStream_t stream);

}  // namespace vpm::cuda
