// Arithmetic of pinhole cameras (vpm/camera.h), for host and device.
#pragma once

#include <vpm/camera.h>

#include <cmath>

#include "libvpm/core/pose.h"

namespace vpm {

// True if focal lengths are positive and no number is infinite, undefined or above
// kLargestIntrinsics pixels, which is far beyond any image.
inline constexpr double kLargestIntrinsics = 0x1p40;
inline bool are_sound(const Intrinsics& k) {
  return k.fx > 0 && k.fy > 0 && k.fx <= kLargestIntrinsics && k.fy <= kLargestIntrinsics &&
         std::abs(k.cx) <= kLargestIntrinsics && std::abs(k.cy) <= kLargestIntrinsics;
}

// Returns the point at depth z (along the optical axis) on the ray (x, y, 1), in camera
// coordinates.
VPM_HD constexpr Vec3 point_on_ray(double x, double y, double z) {
  return {x * z, y * z, z};
}
// Returns the point at depth z that pixel (u, v) sees, in camera coordinates.
VPM_HD constexpr Vec3 unproject(const Intrinsics& k, double u, double v, double z) {
  return point_on_ray((u - k.cx) / k.fx, (v - k.cy) / k.fy, z);
}

// Returns the point at depth z that pixel (u, v) sees, relative to the camera's position but in
// world axes: the form that clouds store.
VPM_HD constexpr Vec3f position_of_pixel(const Camera& camera, double u, double v, double z) {
  return narrow(camera.to_world.rotation * unproject(camera.intrinsics, u, v, z));
}

}  // namespace vpm
