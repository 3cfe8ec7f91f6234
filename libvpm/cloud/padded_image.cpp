#include "libvpm/cloud/padded_image.h"

#include "libvpm/core/lanes.h"

namespace vpm {

void PaddedImage::resize(std::uint32_t new_width, std::uint32_t new_height, int frame,
                         float beyond) {
  const int w = static_cast<int>(new_width), h = static_cast<int>(new_height);
  const std::size_t tiles = (std::size_t{new_width} + kTile - 1) / kTile,
                    around = 2 * static_cast<std::size_t>(frame),
                    row = tiles * kTile + around + kWideLanes,
                    count = row * (std::size_t{new_height} + around);
  if (w == width && h == height && frame == margin && values.size() == count) return;
  values.assign(count, beyond);
  width = w, height = h, margin = frame, stride = row;
}

VPM_VECTOR_CLONES
void take_depth(const DepthImage& depth, int begin, int end, PaddedImage& padded) {
  for (int v = begin; v < end; ++v) {
    const float* from = depth.depth.data() + static_cast<std::size_t>(v) * depth.width;
    float* to = padded.at(0, v);
    for (int u = 0; u < padded.width; ++u) to[u] = usable_depth(from[u]);
  }
}

VPM_VECTOR_CLONES
void take_inverse_depth(const DepthImage& depth, int begin, int end, PaddedImage& inverse) {
  for (int v = begin; v < end; ++v) {
    const float* from = depth.depth.data() + static_cast<std::size_t>(v) * depth.width;
    float* to = inverse.at(0, v);
    for (int u = 0; u < inverse.width; ++u) to[u] = inverse_of_usable(usable_depth(from[u]));
  }
}

}  // namespace vpm
