// Reads the pose of one camera from a file.
#pragma once

#include <string>

#include "libvpm/core/pose.h"

namespace vpm {

// Returns the pose, camera to world, of a file that holds exactly one: in the formats of
// PoseReader, or a JSON object with "matrix", "transform_matrix", "camera_pose" or "pose" (4x4 by
// rows, flat or nested, or 7 numbers), or with "extrinsic" as Open3D writes it (world to camera, by
// columns), which is inverted. `deviation` as in rotation_from_quaternion. Throws Error(refused),
// naming the file, for any other.
Pose read_camera_pose(const std::string& path, double* deviation = nullptr);

}  // namespace vpm
