// Closest points on triangles.
#pragma once

#include <algorithm>

#include "libvpm/core/vec3.h"

namespace vpm {

// Sine of the smallest angle below which a triangle counts as its three edges: its normal is mostly
// rounding, and the error (its height) is below 1e-10 of its longest edge.
inline constexpr double kSliverSine = 1e-10;

inline Vec3 closest_point_on_segment(Vec3 x, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double length2 = squared_norm(along);
  if (!(length2 > 0)) return a;
  return a + std::clamp(dot(x - a, along) / length2, 0.0, 1.0) * along;
}

// Returns the closest point, exact up to rounding for every triangle, also degenerate ones.
inline Vec3 closest_point_on_triangle(Vec3 x, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const Vec3 normal = cross(bc, ca);
  const double normal2 = squared_norm(normal);
  const double edge2 = std::max({squared_norm(ab), squared_norm(bc), squared_norm(ca)});
  const bool flat = normal2 > kSliverSine * kSliverSine * edge2 * edge2;
  const bool beyond_ab = dot(cross(normal, ab), x - a) < 0;
  const bool beyond_bc = dot(cross(normal, bc), x - b) < 0;
  const bool beyond_ca = dot(cross(normal, ca), x - c) < 0;
  if (flat && !beyond_ab && !beyond_bc && !beyond_ca)
    return x - (dot(normal, x - a) / normal2) * normal;
  // The closest point lies on an edge that separates x from the triangle.
  Vec3 best;
  double best2 = HUGE_VAL;
  const auto take = [&](bool considered, Vec3 from, Vec3 to) {
    if (!considered && flat) return;
    const Vec3 p = closest_point_on_segment(x, from, to);
    if (const double d2 = squared_norm(x - p); d2 < best2) best2 = d2, best = p;
  };
  take(beyond_ab, a, b);
  take(beyond_bc, b, c);
  take(beyond_ca, c, a);
  return best;
}

}  // namespace vpm
