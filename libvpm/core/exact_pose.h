// The poses that queries accept.
#pragma once

#include "libvpm/core/pose.h"

namespace vpm {

// Returns the pose with an exact rotation. Pruning relies on exact rotations and differs between
// devices, so a rounded one would change bits. Throws Error(refused) for a translation that is not
// finite or out of range (core/lengths.h), and for a rotation that is off by more than rounding.
Pose exact_pose(const Pose& pose);

}  // namespace vpm
