// The lengths that the arithmetic holds with room to spare.
#pragma once

#include <cmath>

#include "libvpm/core/vec3.h"

namespace vpm {

// Metres. Between these bounds squares and cubes neither overflow nor lose digits in double, and
// what is stored as float32 relative to a tool keeps all of its own. The larger one is a thousand
// times the visible universe.
inline constexpr double kSmallestLength = 0x1p-100, kLargestLength = 0x1p100;

// Whether a vector is finite and no coordinate beyond a bound.
inline bool is_within(Vec3 v, double most) {
  return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}
// The same of a place, and kLargestLength.
inline bool is_in_range(Vec3 p) {
  return is_within(p, kLargestLength);
}

}  // namespace vpm
