// Axes of cameras that other programs use.
#pragma once

#include "libvpm/core/pose.h"

namespace vpm {

enum class CameraAxes {
  opencv,  // x right, y down, z forward: the axes of this library
  opengl,  // x right, y up, z backward
  ros      // x forward, y left, z up: a robot's body
};

// Returns the rotation from this library's axes to the others.
constexpr Rotation to_axes(CameraAxes axes) {
  switch (axes) {
    case CameraAxes::opengl:
      return {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    case CameraAxes::ros:
      return {{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}};
    case CameraAxes::opencv:
      break;
  }
  return {};
}

// Returns the pose that takes this library's axes to the world, of one that takes the others there.
constexpr Pose with_own_axes(const Pose& pose, CameraAxes axes) {
  return {pose.rotation * to_axes(axes), pose.translation};
}

}  // namespace vpm
