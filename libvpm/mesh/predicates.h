// Exact signs of determinants of points in double, and what follows from them of triangles.
#pragma once

#include "libvpm/mesh/exact_sign.h"
#include "libvpm/model/solid.h"

namespace vpm {

struct Vec2 {
  double x = 0, y = 0;
};

// Returns +1 if a, b, c turn counter-clockwise, -1 if clockwise, 0 if collinear.
int orientation(Vec2 a, Vec2 b, Vec2 c);

// True if two triangles of one mesh meet in more than the vertices they share by index. Exact; both
// must have an area.
bool triangles_intersect(const std::vector<Vec3>& vertices, const Triangle& s, const Triangle& t);

// True if the corners are not collinear. Exact.
bool has_area(Vec3 a, Vec3 b, Vec3 c);

}  // namespace vpm
