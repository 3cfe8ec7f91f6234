// Draws for random scenes and poses, which repeat for the same numbers.
#pragma once

#include <algorithm>
#include <cmath>

#include "libvpm/core/pose.h"
#include "libvpm/synthetic/render.h"

namespace vpm::bench {

// Returns a number of a bell-shaped distribution, -2 to 2.
inline double within_two(synthetic::NormalNumbers& numbers) {
  return std::clamp(numbers.next(), -2.0, 2.0);
}

// Returns a uniformly distributed rotation; draws four numbers.
inline Rotation random_rotation(synthetic::NormalNumbers& numbers) {
  const Quaternion q{numbers.next(), numbers.next(), numbers.next(), numbers.next()};
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  return rotation_from_quaternion({q.x / length, q.y / length, q.z / length, q.w / length});
}

}  // namespace vpm::bench
