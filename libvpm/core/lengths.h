// The lengths that the arithmetic holds with room to spare.
#pragma once

#include <cmath>

#include "libvpm/core/vec3.h"

namespace vpm {

// Metres. Between these bounds squares and cubes neither overflow nor lose digits in double, and
// what is stored as float32 relative to a tool keeps all of its own. The larger one is a thousand
// times the visible universe.
inline constexpr double kSmallestLength = 0x1p-100, kLargestLength = 0x1p100;

// Whether a place is finite and no coordinate beyond kLargestLength.
inline bool is_in_range(Vec3 p) {
  return std::abs(p.x) <= kLargestLength && std::abs(p.y) <= kLargestLength &&
         std::abs(p.z) <= kLargestLength;
}

}  // namespace vpm
