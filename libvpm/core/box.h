// Axis-aligned bounding boxes of points in double precision.
#pragma once

#include <algorithm>
#include <cmath>

#include "libvpm/core/vec3.h"

namespace vpm {

// Returns the coordinate along axis 0, 1 or 2 for x, y, z.
inline double coordinate(Vec3 v, int axis) {
  return axis == 0 ? v.x : (axis == 1 ? v.y : v.z);
}

// Axis-aligned bounding box of the points added so far; empty (low > high) before the first.
struct Box {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  void add(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  // Grows the box until it holds another one, too; an empty one changes nothing.
  void add_box(const Box& box) {
    low = {std::min(low.x, box.low.x), std::min(low.y, box.low.y), std::min(low.z, box.low.z)};
    high = {std::max(high.x, box.high.x), std::max(high.y, box.high.y),
            std::max(high.z, box.high.z)};
  }
  Vec3 size() const { return high - low; }
  // Returns the axis (0, 1, 2) of the longest side; the lowest axis on ties.
  int longest_axis() const {
    const Vec3 side = size();
    if (side.x >= side.y && side.x >= side.z) return 0;
    return side.y >= side.z ? 1 : 2;
  }
};

}  // namespace vpm
