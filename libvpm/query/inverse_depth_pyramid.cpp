#include "libvpm/query/inverse_depth_pyramid.h"

#include <algorithm>

#include "libvpm/core/parallel.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

constexpr std::size_t kRowsPerTask = 32;

VPM_VECTOR_CLONES
void take_row(const float* __restrict inverse, std::size_t width,
              InverseDepthRange* __restrict tiles) {
  for (std::size_t u = 0; u < width; ++u) tiles[u] = {inverse[u], inverse[u]};
}

// A row of tiles from two of the level below; the last tile of an odd width has one column.
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

void InverseDepthPyramid::build(const PaddedImage& inverse) {
  auto width = static_cast<std::size_t>(inverse.width),
       height = static_cast<std::size_t>(inverse.height);
  std::size_t count = 1;
  for (std::size_t side = std::max(width, height); side > 1; side = (side + 1) / 2) ++count;
  levels_.resize(count);
  levels_[0].resize(width * height);
  parallel_for(height, kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      take_row(inverse.at(0, static_cast<int>(v)), width, levels_[0].data() + v * width);
  });
  for (std::size_t k = 1; k < count; ++k) {
    const InverseDepthRange* fine = levels_[k - 1].data();
    const std::size_t half_width = (width + 1) / 2, half_height = (height + 1) / 2;
    levels_[k].resize(half_width * half_height);
    parallel_for(half_height, kRowsPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const InverseDepthRange* above = fine + 2 * v * width;
        unite_rows(above, 2 * v + 1 < height ? above + width : above, width,
                   levels_[k].data() + v * half_width);
      }
    });
    width = half_width, height = half_height;
  }
}

}  // namespace vpm
