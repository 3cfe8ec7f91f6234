// Accesses a tile in a block's shared memory about one of its pixels.
#pragma once

#include "libvpm/cloud/normal_window.h"

namespace vpm::cuda {

// Return the stored inverse depth of a pixel that is not measured, a NaN with the greatest integer
// as bits, so that it lies within no gate; and of a pixel beyond the image, as on the host
// (kBeyondImage).
__device__ __forceinline__ float unmeasured() {
  return __int_as_float(0x7fffffff);
}
__device__ __forceinline__ float beyond_image() {
  return __int_as_float(-1);
}
// Returns `inverse`, or unmeasured() for 0.
__device__ __forceinline__ float measured_or_none(float inverse) {
  return inverse == 0 ? unmeasured() : inverse;
}

// Holds least and greatest inverse depth of some pixels as integers, which order like floats that
// are not negative. `high` is a NaN if a pixel is not measured; pixels beyond the image change
// nothing.
struct Extent {
  unsigned low;
  int high;

  __device__ __forceinline__ explicit Extent(float value) {
    low = __float_as_uint(value), high = __float_as_int(value);
  }
  __device__ __forceinline__ Extent(unsigned least, int greatest) : low(least), high(greatest) {}
  __device__ __forceinline__ void take(Extent a, Extent b) {
    low = __vimin3_u32(low, a.low, b.low), high = __vimax3_s32(high, a.high, b.high);
  }
  // True if a window is measured everywhere and has no edge.
  __device__ __forceinline__ bool is_smooth(float centre, const EdgeGate& edges) const {
    return __uint_as_float(low) >= edges.lowest * centre &&
           __int_as_float(high) <= edges.highest * centre;
  }
  // True if floats can hold the squares of the window's depths.
  __device__ __forceinline__ bool is_in_floats(const EdgeGate& edges) const {
    return __uint_as_float(low) >= edges.least && __int_as_float(high) <= edges.greatest;
  }
};

class TileAround {
 public:
  __device__ TileAround(const float* centre, int pitch) : centre_(centre), pitch_(pitch) {}
  __device__ __forceinline__ float at(int du, int dv) const { return centre_[dv * pitch_ + du]; }

 private:
  const float* centre_;
  int pitch_;
};

}  // namespace vpm::cuda
