// An image with a margin around it, for loops over the neighbours of pixels.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/cloud/depth_image.h"

namespace vpm {

// Pixels of a row that are handled at once: a constant number is what compilers turn into vector
// code.
inline constexpr int kTile = 64;

// (0, 0) is the image's own first pixel; coordinates from -margin to size + margin are there, and
// to the right of them enough for the margin of a whole last tile and a group of wide lanes.
struct PaddedImage {
  int width = 0, height = 0, margin = 0;
  std::size_t stride = 0;
  std::vector<float> values;

  // Takes this size; allocates nothing where it has it. What was in the image itself stays there.
  // `beyond`: what stands in the margin, always the same for an image.
  void resize(std::uint32_t width, std::uint32_t height, int margin, float beyond = 0);
  const float* at(int u, int v) const { return values.data() + offset(u, v); }
  float* at(int u, int v) { return values.data() + offset(u, v); }

 private:
  std::size_t offset(int u, int v) const {
    return static_cast<std::size_t>(v + margin) * stride + static_cast<std::size_t>(u + margin);
  }
};

// Depth or its inverse of these rows; 0 where nothing was measured or the depth is out of range.
void take_depth(const DepthImage& depth, int begin, int end, PaddedImage& padded);
void take_inverse_depth(const DepthImage& depth, int begin, int end, PaddedImage& inverse);

}  // namespace vpm
