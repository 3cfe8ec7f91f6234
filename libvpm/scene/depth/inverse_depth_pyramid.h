// Stores ranges of inverse depth over tiles of 1, 2, 4, ... pixels a side, for DepthSurface.
#pragma once

#include <vector>

#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

class InverseDepthPyramid {
 public:
  // Prepares for an image of this size, without new memory where it has it.
  void resize(std::uint32_t width, std::uint32_t height);
  // Returns a row of pixels to be filled: inverse depth as both ends, 0 where unknown.
  InverseDepthRange* row(int v) { return levels_[0].data() + static_cast<std::size_t>(v) * width_; }
  // Unites the pixels to tiles.
  void unite();

  int levels() const { return static_cast<int>(levels_.size()); }
  const std::vector<InverseDepthRange>& level(int k) const {
    return levels_[static_cast<std::size_t>(k)];
  }

 private:
  std::size_t width_ = 0, height_ = 0;
  std::vector<std::vector<InverseDepthRange>> levels_;
};

}  // namespace vpm
