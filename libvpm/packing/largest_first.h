#pragma once

#include "libvpm/model/sphere.h"

namespace vpm {

// Order of a packing: larger radius first, then by centre.
inline bool largest_first(const Sphere& a, const Sphere& b) {
  if (a.radius != b.radius) return a.radius > b.radius;
  if (a.center.x != b.center.x) return a.center.x < b.center.x;
  if (a.center.y != b.center.y) return a.center.y < b.center.y;
  return a.center.z < b.center.z;
}

}  // namespace vpm
