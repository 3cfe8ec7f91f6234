// Closest points on four triangles at once, in the lanes of core/vec3x4.h.
#pragma once

#include <cmath>

#include "libvpm/core/vec3x4.h"
#include "libvpm/mesh/triangle_bvh.h"

namespace vpm {

// Moves `best`, the closest point to x that is known so far, to the closest one of the segment from
// a to b where that is nearer, in the lanes that `take` selects. `best2` is its squared distance.
template <class Mask>
[[gnu::always_inline]] inline void take_segment(const Vec3x4& x, const Vec3x4& a, const Vec3x4& b,
                                                const Mask& take, Vec3x4& best, Double4& best2) {
  const Double4 zero{}, one = zero + 1.0;
  const Vec3x4 along = b - a;
  const Double4 length2 = dot(along, along);
  const Double4 fraction = dot(x - a, along) / length2;
  const Double4 below = one < fraction ? one : fraction, clamped = fraction < zero ? zero : below;
  const Vec3x4 reached = a + clamped * along;
  const auto is_point = length2 <= zero;
  const Vec3x4 p{is_point ? a.x : reached.x, is_point ? a.y : reached.y,
                 is_point ? a.z : reached.z};
  const Vec3x4 from = x - p;
  const Double4 d2 = dot(from, from);
  const auto nearer = take & (d2 < best2);
  best2 = nearer ? d2 : best2;
  best = {nearer ? p.x : best.x, nearer ? p.y : best.y, nearer ? p.z : best.z};
}

// Finds in each lane the point of the triangle abc that is closest to x, and its squared distance.
// A squared distance that is not below `within2` may come out infinite.
[[gnu::always_inline]] inline void closest_points_on_triangles(const Vec3x4& x, const Vec3x4& a,
                                                               const Vec3x4& b, const Vec3x4& c,
                                                               double within2, Vec3x4& best,
                                                               Double4& best2) {
  const Double4 zero{}, infinite = zero + HUGE_VAL;
  const Vec3x4 ab = b - a, bc = c - b, ca = a - c, normal = cross(bc, ca), from_a = x - a;
  const Double4 normal2 = dot(normal, normal), height = dot(normal, from_a);
  const Double4 ab2 = dot(ab, ab), bc2 = dot(bc, bc), ca2 = dot(ca, ca);
  const Double4 two = ab2 < bc2 ? bc2 : ab2, edge2 = two < ca2 ? ca2 : two;
  const auto flat = normal2 > kSliverSine * kSliverSine * edge2 * edge2;
  const auto beyond_ab = dot(cross(normal, ab), from_a) < zero;
  const auto beyond_bc = dot(cross(normal, bc), x - b) < zero;
  const auto beyond_ca = dot(cross(normal, ca), x - c) < zero;
  const auto on_edge = ~flat | beyond_ab | beyond_bc | beyond_ca;
  const Vec3x4 foot = x - (height / normal2) * normal, from_foot = x - foot;
  best = foot;
  best2 = on_edge ? infinite : dot(from_foot, from_foot);
  // No edge is nearer than the plane. The slack covers rounding, above all of slivers' normals.
  const Double4 limit2 = 1.01 * (within2 + 1e-6 * dot(from_a, from_a));
  if (!any(on_edge & (~flat | (height * height <= limit2 * normal2)))) return;
  take_segment(x, a, b, on_edge & (~flat | beyond_ab), best, best2);
  take_segment(x, b, c, on_edge & (~flat | beyond_bc), best, best2);
  take_segment(x, c, a, on_edge & (~flat | beyond_ca), best, best2);
}

}  // namespace vpm
