// Exact volumes of a solid cut by a plane or a ball: the truth that approximations are measured
// against.
#pragma once

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Volume of the part of the solid where dot(normal, x) < offset; `normal` must have unit length.
double volume_below_plane(const Solid& solid, Vec3 normal, double offset);

// Volume of the part of the solid inside the ball.
double volume_in_ball(const Solid& solid, const Sphere& ball);

}  // namespace vpm
