// Images about one of their pixels, as GatedWindow reads them: column(du).value(dv).
#pragma once

#include "libvpm/surface/cuda/cloud_tile.h"

namespace vpm::cuda {

// A tile's image about one of its pixels.
class TileAround {
 public:
  __device__ TileAround(const float* centre, int pitch) : centre_(centre), pitch_(pitch) {}
  class Column {
   public:
    __device__ Column(const float* middle, int pitch) : middle_(middle), pitch_(pitch) {}
    __device__ __forceinline__ float value(int dv) const { return middle_[dv * pitch_]; }

   private:
    const float* middle_;
    int pitch_;
  };
  __device__ __forceinline__ Column column(int du) const { return {centre_ + du, pitch_}; }

 private:
  const float* centre_;
  int pitch_;
};

// All of an image, which is 0 beyond its border. As far as windows go.
class ImageAround {
 public:
  __device__ ImageAround(const CloudRecipe& recipe, const float* image, std::uint32_t pixel)
      : pitch_(static_cast<int>(recipe.camera.width)),
        u_(static_cast<int>(pixel % recipe.camera.width)),
        centre_(image + pixel) {
    const auto v = static_cast<int>(pixel / recipe.camera.width),
               height = static_cast<int>(recipe.camera.height);
    const int above = v < kMost ? v : kMost,
              below = height - 1 - v < kMost ? height - 1 - v : kMost;
    rows_ = ~0U << (kMost - above) & ~0U >> (31 - kMost - below);
  }
  class Column {
   public:
    __device__ Column(const float* middle, int pitch, unsigned rows)
        : middle_(middle), pitch_(pitch), rows_(rows) {}
    __device__ __forceinline__ float value(int dv) const {
      return (rows_ >> (kMost + dv) & 1) != 0 ? middle_[dv * pitch_] : 0.0F;
    }

   private:
    const float* middle_;
    int pitch_;
    unsigned rows_;
  };
  __device__ __forceinline__ Column column(int du) const {
    const int u = u_ + du;
    return {centre_ + du, pitch_, u >= 0 && u < pitch_ ? rows_ : 0U};
  }

 private:
  static constexpr int kMost = kMaxWindow / 2;
  static_assert(2 * kMost + 1 <= 32);
  int pitch_, u_;
  const float* centre_;
  unsigned rows_;  // those of the window that the image has, a bit for each
};

}  // namespace vpm::cuda
