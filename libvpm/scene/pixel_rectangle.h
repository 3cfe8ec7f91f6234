// Computes the pixels in which a camera sees a ball, for host and device.
#pragma once

#include <cmath>

#include "libvpm/cloud/camera.h"

namespace vpm {

struct PixelRectangle {
  std::int32_t u0 = 0, v0 = 0, u1 = -1, v1 = -1;  // inclusive; empty if u0 > u1
};

VPM_HD constexpr PixelRectangle whole_image(std::int32_t width, std::int32_t height) {
  return {0, 0, width - 1, height - 1};
}
VPM_HD constexpr bool is_empty(const PixelRectangle& r) {
  return r.u0 > r.u1 || r.v0 > r.v1;
}

// Bounds the offset of a point from its pixel, in pixels, for which searches over pixels find it;
// float32 rounding and recovered intrinsics stay far below.
inline constexpr double kPixelTolerance = 0.5;

// Computes the pixels [first, last] along one axis of a ball that spans [low, high] sideways and
// [nearest, farthest] in depth (both > 0).
VPM_HD inline void pixel_range(double low, double high, double nearest, double farthest, double f,
                               double c, std::int32_t size, std::int32_t& first,
                               std::int32_t& last) {
  const double begin = f * (low / (low >= 0 ? farthest : nearest)) + c - kPixelTolerance;
  const double end = f * (high / (high >= 0 ? nearest : farthest)) + c + kPixelTolerance;
  const double lowest = std::floor(begin), highest = std::ceil(end);
  first = static_cast<std::int32_t>(lowest > 0 ? (lowest < size ? lowest : size) : 0.0);
  last =
      static_cast<std::int32_t>(highest > -1 ? (highest < size - 1 ? highest : size - 1.0) : -1.0);
}

// Returns a rectangle with every pixel whose point may lie in the ball. Camera coordinates.
VPM_HD inline PixelRectangle rectangle_of_ball(const Intrinsics& k, std::int32_t width,
                                               std::int32_t height, Vec3 center, double radius) {
  const double nearest = center.z - radius, farthest = center.z + radius;
  if (!(farthest > 0)) return {};
  if (!(nearest > 0)) return whole_image(width, height);
  PixelRectangle r;
  pixel_range(center.x - radius, center.x + radius, nearest, farthest, k.fx, k.cx, width, r.u0,
              r.u1);
  pixel_range(center.y - radius, center.y + radius, nearest, farthest, k.fy, k.cy, height, r.v0,
              r.v1);
  return r;
}

}  // namespace vpm
