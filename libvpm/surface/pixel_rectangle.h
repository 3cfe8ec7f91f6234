// The pixels in which a camera sees a ball. One definition for host and device.
#pragma once

#include <algorithm>

#include "libvpm/cloud/camera.h"

namespace vpm {

struct PixelRectangle {
  std::int32_t u0 = 0, v0 = 0, u1 = -1, v1 = -1;  // inclusive; empty if u0 > u1

  bool operator==(const PixelRectangle&) const = default;
};

VPM_HD constexpr PixelRectangle whole_image(std::int32_t width, std::int32_t height) {
  return {0, 0, width - 1, height - 1};
}
VPM_HD constexpr bool is_empty(const PixelRectangle& r) {
  return r.u0 > r.u1 || r.v0 > r.v1;
}
constexpr std::int64_t pixel_count(const PixelRectangle& r) {
  return is_empty(r) ? 0 : std::int64_t{r.u1 - r.u0 + 1} * (r.v1 - r.v0 + 1);
}
VPM_HD constexpr bool holds(const PixelRectangle& all, const PixelRectangle& part) {
  return part.u0 >= all.u0 && part.v0 >= all.v0 && part.u1 <= all.u1 && part.v1 <= all.v1;
}

// The least that holds both.
constexpr PixelRectangle united(const PixelRectangle& a, const PixelRectangle& b) {
  if (is_empty(a)) return b;
  if (is_empty(b)) return a;
  return {std::min(a.u0, b.u0), std::min(a.v0, b.v0), std::max(a.u1, b.u1), std::max(a.v1, b.v1)};
}
// With a margin, then to whole tiles of so many pixels, as far as the image goes. Nothing has none.
VPM_HD constexpr PixelRectangle widened(const PixelRectangle& r, std::int32_t margin,
                                        std::int32_t tile_width, std::int32_t tile_height,
                                        std::int32_t width, std::int32_t height) {
  if (is_empty(r)) return {};
  const auto down = [&](std::int32_t first, std::int32_t tile) {
    return first > margin ? (first - margin) / tile * tile : 0;
  };
  const auto up = [&](std::int32_t last, std::int32_t tile, std::int32_t size) {
    const std::int32_t most = size - 1, wanted = last + margin < most ? last + margin : most;
    const std::int32_t whole = wanted / tile * tile + tile - 1;
    return whole < most ? whole : most;
  };
  return {down(r.u0, tile_width), down(r.v0, tile_height), up(r.u1, tile_width, width),
          up(r.v1, tile_height, height)};
}

// A point off its pixel by more than this would be missed by the search over pixels; float32
// rounding and recovered intrinsics stay far below.
inline constexpr double kPixelTolerance = 0.5;

// Along one axis: the ball spans [low, high] sideways, and [nearest, farthest] in depth (both > 0).
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

// Camera coordinates. Holds every pixel whose point may lie in the ball.
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
