// Rotations for poses that are to be any.
#pragma once

#include <cmath>

#include "libvpm/core/pose.h"
#include "libvpm/synthetic/kinect_noise.h"

namespace vpm::bench {

// Each as likely as any other; takes four numbers.
inline Rotation random_rotation(synthetic::NormalNumbers& numbers) {
  const Quaternion q{numbers.next(), numbers.next(), numbers.next(), numbers.next()};
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  return rotation_from_quaternion({q.x / length, q.y / length, q.z / length, q.w / length});
}

}  // namespace vpm::bench
