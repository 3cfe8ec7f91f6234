// Rotations as vectors: axis times angle in radians. They use the C library's functions, so results
// may differ in the last bits between machines.
#pragma once

#include "libvpm/core/pose.h"

namespace vpm {

// Returns the shortest rotation, with an angle in [0, pi].
Vec3 rotation_vector(const Rotation& r);
Rotation rotation_from_vector(Vec3 v);

// Returns the rotation at `part`, 0 to 1, of the shortest rotation from `from` to `to`.
Rotation interpolate(const Rotation& from, const Rotation& to, double part);

}  // namespace vpm
