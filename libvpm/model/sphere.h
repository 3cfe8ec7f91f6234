#pragma once

#include "libvpm/core/vec3.h"

namespace vpm {

inline constexpr double kPi = 3.14159265358979323846;

VPM_HD constexpr double volume(const Sphere& s) {
  return 4.0 / 3.0 * kPi * s.radius * s.radius * s.radius;
}

// Order of a packing: larger radius first, then by centre.
inline bool largest_first(const Sphere& a, const Sphere& b) {
  if (a.radius != b.radius) return a.radius > b.radius;
  if (a.center.x != b.center.x) return a.center.x < b.center.x;
  if (a.center.y != b.center.y) return a.center.y < b.center.y;
  return a.center.z < b.center.z;
}

}  // namespace vpm
