// Exact volumes of a solid cut by a plane or a ball, as reference for approximations.
#pragma once

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Returns the volume of the part of the solid where dot(normal, x) < offset; `normal` must be of
// unit length.
double volume_below_plane(const Solid& solid, Vec3 normal, double offset);

// Returns the volume of the part of the solid inside the ball.
double volume_in_ball(const Solid& solid, const Sphere& ball);

}  // namespace vpm
