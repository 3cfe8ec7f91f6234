// Makes points with normals, and the image without holes, from the depths that cloud_take.h brought
// to the device, with the bits of make_cloud(). cloud_denoise.h makes the surface from these.
#pragma once

#include "libvpm/cloud/normals.h"
#include "libvpm/device/cuda/numbered_word.h"
#include "libvpm/scene/cuda/cloud_tile.h"

namespace vpm::cuda {

// Holds the results of an image's preparation, in memory that the host reads.
struct CloudAnswer {
  NumberedWord points = 0;    // number of points with a normal
  NumberedWord doubtful = 0;  // not 0: there are points that a PreparedCloud might refuse
};

struct CloudCounters {
  unsigned points = 0, doubtful = 0;
  unsigned done = 0;  // finished blocks of a launch; 0 between launches
};

// Adds a block's counts; call it from one thread of each block. At last one calls answer_with().
__device__ inline void count(unsigned points, unsigned doubtful, CloudCounters& counters) {
  if (points > 0) atomicAdd(&counters.points, points);
  if (doubtful > 0) atomicAdd(&counters.doubtful, doubtful);
}
__device__ inline void answer_with(const volatile CloudCounters& counters, CloudAnswer* answer,
                                   unsigned sequence) {
  put(numbered(sequence, counters.doubtful), answer->doubtful);
  put(numbered(sequence, counters.points), answer->points);
}

// Tells what the current device can do with windows of this size.
struct Preparation {
  bool fits = false;      // shared memory holds them
  bool overlaps = false;  // the kernel may be launched before take_image() ends
};
Preparation preparation_of(const NormalOptions& options);

// Launches after take_image() in the same stream. The answer comes when the last normal is known.
void prepare_on_device(const CloudRecipe& recipe, NormalMethod method,
                       const Preparation& preparation, CloudCounters* counters, CloudAnswer* answer,
                       unsigned sequence, cudaStream_t stream);

}  // namespace vpm::cuda
