#include "libvpm/core/exact_pose.h"

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"

namespace vpm {

Pose exact_pose(const Pose& pose) {
  if (!is_in_range(pose.translation))
    refuse("the translation is not finite, or further than 2^100 m from the origin", "pose");
  if (is_rotation(pose.rotation, kRotationExact)) return pose;
  if (!is_rotation(pose.rotation, kRotationRounding))
    refuse("its rotation is not finite, not orthonormal or mirrors", "pose",
           "make it with rotation_from_matrix or rotation_from_quaternion");
  return {exact_rotation(pose.rotation), pose.translation};
}

}  // namespace vpm
