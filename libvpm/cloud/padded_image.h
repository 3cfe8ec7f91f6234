// Image with a margin, for loops over neighbours of pixels.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/cloud/depth_image.h"
#include "libvpm/core/vec3.h"

namespace vpm {

// Number of pixels of a row that are handled at once; a constant, so that loops vectorise.
inline constexpr int kTile = 64;

// Coordinates run from -margin to size + margin; (0, 0) is the image's first pixel. Rows are padded
// further, for the margin of a whole last tile and a group of wide lanes.
struct PaddedImage {
  int width = 0, height = 0, margin = 0;
  std::size_t stride = 0;
  std::vector<float> values;

  // Sets the size and fills the margin with `beyond`, which must always be the same for an image.
  // Keeps the image's pixels, and allocates nothing, if the size is the same.
  void resize(std::uint32_t width, std::uint32_t height, int margin, float beyond = 0);
  const float* at(int u, int v) const { return values.data() + offset(u, v); }
  float* at(int u, int v) { return values.data() + offset(u, v); }

 private:
  std::size_t offset(int u, int v) const {
    return static_cast<std::size_t>(v + margin) * stride + static_cast<std::size_t>(u + margin);
  }
};

// Copy these rows' depths, or their inverses; 0 where unmeasured or out of range.
void take_depth(const DepthImage& depth, int begin, int end, PaddedImage& padded);
void take_inverse_depth(const DepthImage& depth, int begin, int end, PaddedImage& inverse);

// Vectors of a tile's pixels, stored by coordinate so that loops vectorise.
struct VectorTile {
  float x[kTile], y[kTile], z[kTile];

  // Stores the first `count` vectors.
  [[gnu::always_inline]] void store(int count, Vec3f* to) const {
    if (count == kTile) {
      for (int i = 0; i < kTile; ++i) to[i] = {x[i], y[i], z[i]};
    } else {
      for (int i = 0; i < count; ++i) to[i] = {x[i], y[i], z[i]};
    }
  }
};

}  // namespace vpm
