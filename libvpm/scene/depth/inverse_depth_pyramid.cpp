#include "libvpm/scene/depth/inverse_depth_pyramid.h"

#include <algorithm>

#include "libvpm/cloud/row_bands.h"
#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

// Unites two rows of tiles to one of the next level; the last tile of an odd width has one column.
VPM_VECTOR_CLONES
void unite_rows(const InverseDepthRange* __restrict above,
                const InverseDepthRange* __restrict below, std::size_t width,
                InverseDepthRange* __restrict tiles) {
  for (std::size_t u = 0; u < width / 2; ++u) {
    tiles[u] =
        united(united(above[2 * u], above[2 * u + 1]), united(below[2 * u], below[2 * u + 1]));
  }
  if (width % 2 != 0) tiles[width / 2] = united(above[width - 1], below[width - 1]);
}

}  // namespace

void InverseDepthPyramid::resize(std::uint32_t new_width, std::uint32_t new_height) {
  width_ = new_width, height_ = new_height;
  std::size_t count = 1;
  for (std::size_t side = std::max(width_, height_); side > 1; side = (side + 1) / 2) ++count;
  levels_.resize(count);
  std::size_t width = width_, height = height_;
  for (std::vector<InverseDepthRange>& level : levels_) {
    level.resize(width * height);
    width = (width + 1) / 2, height = (height + 1) / 2;
  }
}

void InverseDepthPyramid::unite() {
  std::size_t width = width_, height = height_;
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const InverseDepthRange* fine = levels_[k - 1].data();
    const std::size_t half_width = (width + 1) / 2, half_height = (height + 1) / 2;
    for_bands(static_cast<int>(half_height), [&](int begin, int end) {
      for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
        const InverseDepthRange* above = fine + 2 * v * width;
        unite_rows(above, 2 * v + 1 < height ? above + width : above, width,
                   levels_[k].data() + v * half_width);
      }
    });
    width = half_width, height = half_height;
  }
}

}  // namespace vpm
