// Exact signs of determinants of points in double: a floating-point filter first, expansion
// arithmetic where it cannot decide (Shewchuk 1997, "Adaptive precision floating-point arithmetic
// and fast robust geometric predicates"). Exact for coordinates of magnitudes from 1e-90 to 1e90,
// for which no product overflows or underflows.
#pragma once

#include "libvpm/core/vec3.h"
#include "libvpm/model/solid.h"

namespace vpm {

struct Vec2 {
  double x = 0, y = 0;
};

// Returns +1 if a, b, c turn counter-clockwise, -1 if clockwise, 0 if collinear.
int orientation(Vec2 a, Vec2 b, Vec2 c);

// Returns the sign of (a - d) . ((b - d) x (c - d)): +1 if d lies below the plane in which a, b, c
// turn counter-clockwise seen from above, 0 if on it.
int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

// True if two triangles of one mesh meet in more than the vertices they share by index. Exact; both
// must have an area.
bool triangles_intersect(const std::vector<Vec3>& vertices, const Triangle& s, const Triangle& t);

// True if the corners are not collinear. Exact.
bool has_area(Vec3 a, Vec3 b, Vec3 c);

}  // namespace vpm
