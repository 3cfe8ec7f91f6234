// From a depth image in the host's memory to points with normals on a device: what make_cloud()
// makes of it, bit by bit, and the image without holes. cloud_settle.h makes the surface of that.
#pragma once

#include "libvpm/cloud/normals.h"
#include "libvpm/query/cuda/cloud_tile.h"
#include "libvpm/query/cuda/numbered_word.h"

namespace vpm::cuda {

// A depth image as the sensor gives it, counts or metres, in memory of the host that the device
// reads over the bus.
struct DepthSource {
  const std::uint16_t* counts = nullptr;
  const float* metres = nullptr;
  double counts_per_metre = 1;
};

// Where the host looks for what came of an image.
struct CloudAnswer {
  NumberedWord points = 0;    // with a normal
  NumberedWord doubtful = 0;  // points that a PreparedCloud might refuse
};

struct CloudCounters {
  unsigned points = 0, doubtful = 0;
  unsigned done = 0;  // blocks of a launch; 0 between launches
};

// Pixels that one thread takes; images and what is made of them have room for the last thread's.
inline constexpr unsigned kPixelsAtOnce = 8;

// Brings the part of the image that the tiles of a recipe are made of to the device: depths and
// their inverses, as recipes want them. With the first tiles of an image it clears what
// settle_on_device() (cloud_settle.h) adds up, and the counters.
void take_image(const DepthSource& source, float* depth, float* inverse, const CloudRecipe& recipe,
                CloudCounters* counters, cudaStream_t stream);

// What the current device can do with windows of this size.
struct Preparation {
  bool fits = false;      // its shared memory holds them
  bool overlaps = false;  // the kernel may be launched before take_image() is done
};
Preparation preparation_of(const NormalOptions& options);

// After take_image() in the same stream. The answer, of all tiles made so far, comes when the last
// normal is known.
void prepare_on_device(const CloudRecipe& recipe, NormalMethod method,
                       const Preparation& preparation, CloudCounters* counters, CloudAnswer* answer,
                       unsigned sequence, cudaStream_t stream);

}  // namespace vpm::cuda
