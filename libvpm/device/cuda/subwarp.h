// Groups lanes of a warp that work together.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "libvpm/core/vec3.h"

namespace vpm::cuda {

// Groups `width` lanes that follow one another; `width` is a power of two.
struct Subwarp {
  unsigned width, lane, mask;

  __device__ explicit Subwarp(unsigned tile_width)
      : width(tile_width), lane(threadIdx.x % tile_width) {
    const unsigned first = threadIdx.x % 32 - lane;
    mask = (width == 32 ? ~0U : (1U << width) - 1) << first;
  }
  __device__ bool leads() const { return lane == 0; }
  // Uses shuffles: ballots with a mask for each subwarp would serialise.
  __device__ bool any(bool value) const {
    unsigned found = value ? 1 : 0;
#pragma unroll 1
    for (unsigned other = width / 2; other > 0; other /= 2)
      found |= __shfl_xor_sync(mask, found, static_cast<int>(other), static_cast<int>(width));
    return found != 0;
  }
  // Returns a bit for each lane.
  __device__ unsigned which(bool value) const {
    return __ballot_sync(mask, value) >> (threadIdx.x % 32 - lane);
  }
  // Returns the number of lanes before this one that which() has found.
  __device__ unsigned before(unsigned found) const {
    return __popc(found & ((1U << lane) - 1));
  }
  // Counts the lanes that which() has found. Returns the slot of each of them.
  __device__ unsigned take_slots(unsigned& counter, unsigned found) const {
    unsigned slot = 0;
    if (leads() && found != 0) slot = atomicAdd(&counter, __popc(found));
    return from(slot, 0) + before(found);
  }
  template <class T>
  __device__ T from(T value, unsigned source) const {
    return __shfl_sync(mask, value, static_cast<int>(source), static_cast<int>(width));
  }
  __device__ Vec3 from(Vec3 v, unsigned source) const {
    return {from(v.x, source), from(v.y, source), from(v.z, source)};
  }
  // Returns the value of the lane `lanes` further on.
  __device__ double from_next(double value, unsigned lanes) const {
    return __shfl_down_sync(mask, value, lanes, static_cast<int>(width));
  }
  __device__ Vec3 from_next(Vec3 v, unsigned lanes) const {
    return {from_next(v.x, lanes), from_next(v.y, lanes), from_next(v.z, lanes)};
  }
  __device__ std::int64_t sum(std::int64_t value) const {
    for (unsigned other = width / 2; other > 0; other /= 2)
      value += __shfl_xor_sync(mask, value, static_cast<int>(other), static_cast<int>(width));
    return value;
  }
};

// Exchanges values among all lanes of a warp, whose mask takes no register then.
struct Warp {
  __device__ static double from(double value, unsigned lane) {
    return __shfl_sync(~0U, value, static_cast<int>(lane));
  }
  __device__ static Vec3 from(Vec3 v, unsigned lane) {
    return {from(v.x, lane), from(v.y, lane), from(v.z, lane)};
  }
  // Returns the value of the lane `lanes` further on.
  __device__ static double from_next(double value, unsigned lanes) {
    return __shfl_down_sync(~0U, value, lanes);
  }
  __device__ static Vec3 from_next(Vec3 v, unsigned lanes) {
    return {from_next(v.x, lanes), from_next(v.y, lanes), from_next(v.z, lanes)};
  }
  // Returns the sum of the values in the lanes up to this one.
  __device__ static unsigned sum_upto(unsigned value) {
    for (unsigned step = 1; step < 32; step *= 2) {
      const unsigned lower = __shfl_up_sync(~0U, value, step);
      if (threadIdx.x % 32 >= step) value += lower;
    }
    return value;
  }
  // Adds up eight values over the lanes. Lane l returns the sum of value l / 4.
  __device__ static std::int64_t add_up(std::int64_t (&values)[8]) {
    // Halves the values and the lanes that hold them in each step.
#pragma unroll
    for (unsigned half = 16, kept = 4; kept > 0; half /= 2, kept /= 2) {
      const bool is_upper = (threadIdx.x & half) != 0;
#pragma unroll
      for (unsigned k = 0; k < kept; ++k) {
        const std::int64_t low = values[k], high = values[k + kept];
        values[k] = (is_upper ? high : low) + __shfl_xor_sync(~0U, is_upper ? low : high, half);
      }
    }
    std::int64_t sum = values[0];
    sum += __shfl_xor_sync(~0U, sum, 2);
    return sum + __shfl_xor_sync(~0U, sum, 1);
  }
};

}  // namespace vpm::cuda
