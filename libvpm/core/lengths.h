// Range of lengths that the arithmetic supports.
#pragma once

#include <cmath>

#include "libvpm/core/vec3.h"

namespace vpm {

// Bounds in metres. Between them, squares and cubes neither overflow nor lose digits in double, and
// float32 positions relative to a tool keep all their digits. The upper bound is a thousand times
// the observable universe.
inline constexpr double kSmallestLength = 0x1p-100, kLargestLength = 0x1p100;

// True if all coordinates are finite and at most `most` in magnitude.
VPM_HD inline bool is_within(Vec3 v, double most) {
  return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}
// True if all coordinates are finite and at most kLargestLength in magnitude.
VPM_HD inline bool is_in_range(Vec3 p) {
  return is_within(p, kLargestLength);
}

}  // namespace vpm
