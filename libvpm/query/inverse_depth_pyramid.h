// Ranges of inverse depth over tiles of 1, 2, 4, ... pixels a side: what a DepthSurface reads.
#pragma once

#include <vector>

#include "libvpm/cloud/padded_image.h"
#include "libvpm/query/depth_surface.h"

namespace vpm {

class InverseDepthPyramid {
 public:
  // Of an image of inverse depth, 0 where nothing is known. Takes no new memory for an image of the
  // size before.
  void build(const PaddedImage& inverse);

  int levels() const { return static_cast<int>(levels_.size()); }
  const std::vector<InverseDepthRange>& level(int k) const {
    return levels_[static_cast<std::size_t>(k)];
  }

 private:
  std::vector<std::vector<InverseDepthRange>> levels_;
};

}  // namespace vpm
