#include "libvpm/cloud/padded_image.h"

#include "libvpm/core/lanes.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {

void PaddedImage::resize(std::uint32_t new_width, std::uint32_t new_height, int frame) {
  const int w = static_cast<int>(new_width), h = static_cast<int>(new_height);
  if (w == width && h == height && frame == margin) return;
  width = w, height = h, margin = frame;
  stride = std::size_t{new_width} + 2 * static_cast<std::size_t>(frame) + kLanes;
  values.assign(stride * (std::size_t{new_height} + 2 * static_cast<std::size_t>(frame)) + kTile,
                0.0F);
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
