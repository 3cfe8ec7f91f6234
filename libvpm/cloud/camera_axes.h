// Names of the axes that other programs give cameras, and turns between them.
#pragma once

#include <vpm/camera.h>

#include <optional>
#include <string_view>

#include "libvpm/core/pose.h"

namespace vpm {

struct AxesName {
  CameraAxes axes;
  const char* name;   // word of the option
  const char* words;  // "x right, y down, z forward"
};

inline constexpr AxesName kAxesNames[] = {
    {CameraAxes::opencv, "opencv", "x right, y down, z forward"},
    {CameraAxes::opengl, "opengl", "x right, y up, z backward"},
    {CameraAxes::ros, "ros", "x forward, y left, z up"},
};

// Return the name of axes, and the axes of a name; nothing for another word.
constexpr const char* name_of(CameraAxes axes) {
  for (const AxesName& known : kAxesNames)
    if (known.axes == axes) return known.name;
  return "";
}
constexpr std::optional<CameraAxes> axes_named(std::string_view name) {
  for (const AxesName& known : kAxesNames)
    if (known.name == name) return known.axes;
  return std::nullopt;
}

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

// Returns the pose in the world of a frame with this library's axes, given that of the same frame
// with the other axes.
constexpr Pose with_own_axes(const Pose& pose, CameraAxes axes) {
  return {pose.rotation * to_axes(axes), pose.translation};
}

}  // namespace vpm
