// From a depth image in the host's memory to depths on a device, of all of it or of a part.
#pragma once

#include <math_constants.h>

#include "libvpm/surface/cuda/cloud_prepare.h"

namespace vpm::cuda {

// A depth image as the sensor gives it, counts or metres, in memory of the host that the device
// reads over the bus.
struct DepthSource {
  const std::uint16_t* counts = nullptr;
  const float* metres = nullptr;
  double counts_per_metre = 1;
};

// Where its pixels go: depths, if anybody wants them, and their inverses, as recipes have them.
struct TakenDepths {
  float *depth = nullptr, *inverse = nullptr;
};

// Images, and what is made of them, have room for whole groups of so many pixels.
inline constexpr unsigned kMostPixelsAtOnce = 8;

// Brings pixels of an image to the device, groups of them: more at once for all of an image, fewer
// by more threads where there are enough. `kStays`: in a kernel that meets the same memory with
// another image; it keeps nothing near.
template <unsigned kPixelsAtOnce, bool kStays>
class TakeWork {
  static_assert(kMostPixelsAtOnce % kPixelsAtOnce == 0 && kPixelsAtOnce % 4 == 0);

 public:
  __host__ __device__ TakeWork(const DepthSource& source, const TakenDepths& taken,
                               const StepPixels& pixels, unsigned width)
      : source_(source), taken_(taken), wanted_(pixels.wanted), made_(pixels.made), width_(width) {}

  // One for each thread.
  __host__ __device__ unsigned groups() const { return rows() * groups_per_row(); }

  __device__ void take(unsigned group) const {
    const unsigned row = group / groups_per_row(), in_row = group % groups_per_row();
    const std::int64_t v = wanted_.v0 + row, begin = v * width_;
    const std::int64_t first = ((begin + wanted_.u0) / kPixelsAtOnce + in_row) * kPixelsAtOnce;
    if (first > begin + wanted_.u1 || was_taken(first - begin, v)) return;
    float4 depth[kPixelsAtOnce / 4];
#pragma unroll
    for (unsigned k = 0; k < kPixelsAtOnce / 4; ++k)
      depth[k] = four(static_cast<std::size_t>(first) + 4 * k);
#pragma unroll
    for (unsigned k = 0; k < kPixelsAtOnce / 4; ++k)
      put(depth[k], static_cast<std::size_t>(first) + 4 * k);
  }

 private:
  // They go on from row to row, so some groups have pixels in two.
  __host__ __device__ unsigned groups_per_row() const {
    return static_cast<unsigned>(wanted_.u1 - wanted_.u0) / kPixelsAtOnce + 2;
  }
  __host__ __device__ unsigned rows() const {
    return static_cast<unsigned>(wanted_.v1 - wanted_.v0 + 1);
  }
  __device__ bool was_taken(std::int64_t u, std::int64_t v) const {
    return v >= made_.v0 && v <= made_.v1 && u >= made_.u0 && u + kPixelsAtOnce - 1 <= made_.u1;
  }

  // Four depths in metres.
  __device__ float4 four(std::size_t first) const {
    if (source_.counts == nullptr)
      return read(reinterpret_cast<const float4*>(source_.metres + first));
    const uint2 words = read(reinterpret_cast<const uint2*>(source_.counts + first));
    const auto metres = [&](unsigned count) {
      return depth_in_metres(count & 0xffffU, source_.counts_per_metre);
    };
    return {metres(words.x), metres(words.x >> 16), metres(words.y), metres(words.y >> 16)};
  }
  template <class T>
  __device__ static T read(const T* from) {
    if constexpr (kStays) return __ldcv(from);
    return *from;
  }
  __device__ void put(float4 d, std::size_t first) const {
    d = {usable_depth(d.x), usable_depth(d.y), usable_depth(d.z), usable_depth(d.w)};
    if (taken_.depth != nullptr) *reinterpret_cast<float4*>(taken_.depth + first) = d;
    *reinterpret_cast<float4*>(taken_.inverse + first) = {
        inverse_of_usable(d.x), inverse_of_usable(d.y), inverse_of_usable(d.z),
        inverse_of_usable(d.w)};
  }

  DepthSource source_;
  TakenDepths taken_;
  PixelRectangle wanted_, made_;
  unsigned width_;
};

// The coarse tiles, those of several blocks' pixels, begin with what adds nothing. By many threads.
__device__ inline void clear_coarse_tiles(const CloudRoom& room, const Camera& camera,
                                          unsigned thread, unsigned threads) {
  for (int level = kTileLevels + 1; level < room.levels; ++level) {
    const std::size_t count =
        std::size_t{((camera.width - 1) >> level) + 1} * (((camera.height - 1) >> level) + 1);
    for (std::size_t k = thread; k < count; k += threads) room.tiles[level][k] = {CUDART_INF_F, 0};
  }
}

// Brings pixels of the image to the device. Clears the counters where it has taken none before, and
// where it is to the coarse tiles, which settle_on_device() (cloud_settle.h) adds to.
void take_image(const DepthSource& source, const TakenDepths& taken, const CloudRecipe& recipe,
                const StepPixels& pixels, bool clears_tiles, CloudCounters* counters,
                cudaStream_t stream);

}  // namespace vpm::cuda
