#pragma once

#include "libvpm/cloud/padded_image.h"
#include "libvpm/core/vec3.h"

namespace vpm {

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
