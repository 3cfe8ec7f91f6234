// Exact signs of determinants of double-precision points: a floating-point filter first, expansion
// arithmetic where it cannot decide (Shewchuk 1997, "Adaptive precision floating-point arithmetic
// and fast robust geometric predicates"). Exact unless a product overflows or underflows, which
// coordinates of magnitudes between 1e-90 and 1e90 cannot cause.
#pragma once

#include "libvpm/core/vec3.h"

namespace vpm {

struct Vec2 {
  double x = 0, y = 0;
};

// +1 where a, b, c turn counter-clockwise, -1 clockwise, 0 on one line.
int orientation(Vec2 a, Vec2 b, Vec2 c);

// The sign of (a - d) . ((b - d) x (c - d)): +1 where d lies below the plane in which a, b, c
// turn counter-clockwise seen from above; 0 on it.
int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

}  // namespace vpm
