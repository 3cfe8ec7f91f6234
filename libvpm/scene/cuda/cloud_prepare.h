// From the depths that cloud_take.h has brought to points with normals on a device: what
// make_cloud() makes of them, bit by bit, and the image without holes. cloud_denoise.h makes the
// surface of that.
#pragma once

#include "libvpm/cloud/normals.h"
#include "libvpm/device/cuda/numbered_word.h"
#include "libvpm/scene/cuda/cloud_tile.h"

namespace vpm::cuda {

// Where the host looks for what came of an image.
struct CloudAnswer {
  NumberedWord points = 0;    // with a normal
  NumberedWord doubtful = 0;  // not 0: there are points that a PreparedCloud might refuse
};

struct CloudCounters {
  unsigned points = 0, doubtful = 0;
  unsigned done = 0;  // blocks of a launch; 0 between launches
};

// By one thread of each block, with what it has counted; then, when all have come, by one.
__device__ inline void count(unsigned points, unsigned doubtful, CloudCounters& counters) {
  if (points > 0) atomicAdd(&counters.points, points);
  if (doubtful > 0) atomicAdd(&counters.doubtful, doubtful);
}
__device__ inline void answer_with(const volatile CloudCounters& counters, CloudAnswer* answer,
                                   unsigned sequence) {
  put(numbered(sequence, counters.doubtful), answer->doubtful);
  put(numbered(sequence, counters.points), answer->points);
}

// What the current device can do with windows of this size.
struct Preparation {
  bool fits = false;      // its shared memory holds them
  bool overlaps = false;  // the kernel may be launched before take_image() is done
};
Preparation preparation_of(const NormalOptions& options);

// After take_image() in the same stream. The answer comes when the last normal is known.
void prepare_on_device(const CloudRecipe& recipe, NormalMethod method,
                       const Preparation& preparation, CloudCounters* counters, CloudAnswer* answer,
                       unsigned sequence, cudaStream_t stream);

}  // namespace vpm::cuda
