#pragma once

#include "libvpm/model/solid.h"

namespace vpm {

// True if two triangles of one mesh meet in more than the vertices they share by index. Exact; both
// must have an area.
bool triangles_intersect(const std::vector<Vec3>& vertices, const Triangle& s, const Triangle& t);

// True if the corners are not collinear. Exact.
bool has_area(Vec3 a, Vec3 b, Vec3 c);

}  // namespace vpm
