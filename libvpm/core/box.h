#pragma once

#include <algorithm>
#include <cmath>

#include "libvpm/core/vec3.h"

namespace vpm {

// The smallest box along the axes that holds what has been added; empty (low > high) before.
struct Box {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  void add(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Vec3 size() const { return high - low; }
};

}  // namespace vpm
