// Rotations as vectors: axis times angle, in radians. Functions of the C library: results are not
// promised to the last bit between machines.
#pragma once

#include "libvpm/core/pose.h"

namespace vpm {

// The shortest turn, angle in [0, pi].
Vec3 rotation_vector(const Rotation& r);
Rotation rotation_from_vector(Vec3 v);

// The rotation at `part` (0..1) of the shortest turn from one to another.
Rotation interpolate(const Rotation& from, const Rotation& to, double part);

}  // namespace vpm
