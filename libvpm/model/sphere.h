#pragma once

#include "libvpm/core/vec3.h"

namespace vpm {

inline constexpr double kPi = 3.14159265358979323846;

VPM_HD constexpr double volume(const Sphere& s) {
  return 4.0 / 3.0 * kPi * s.radius * s.radius * s.radius;
}

}  // namespace vpm
