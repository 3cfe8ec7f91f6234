// DepthSurface: the nearest place of the surface, and which side of a crease it lies on.
#pragma once

#include "libvpm/surface/depth_surface.h"

namespace vpm {

VPM_HD inline Vec3 DepthSurface::closest_normal(Vec3 x, const Reading& reading) const {
  Reading first = reading;
  const auto i = static_cast<std::int32_t>(reading.point);
  take_one_side(x, neighbors_of(i % width, i / width), first);
  Vec3 foot = first.foot, normal = first.normal;
  double squared = squared_norm(x - foot);
  Vec3 target = x - first.distance * normal;
  const double pixel = foot.z / k.fx, near = kFootPixels * pixel;
  for (int step = 0; step < kFootSteps && squared_norm(target - foot) > near * near; ++step) {
    Neighbors neighbors;
    Reading next =
        read_and(target, [&](std::int32_t u, std::int32_t v) { neighbors = neighbors_of(u, v); });
    if (!next.known) break;
    take_one_side(x, neighbors, next);
    const double next_squared = squared_norm(x - next.foot);
    if (next_squared < squared) {
      foot = next.foot;
      normal = next.normal;
      squared = next_squared;
      target = x - dot(normal, x - foot) * normal;
    } else if (dot(normal, next.normal) > kSmoothCosine) {
      return normalized_or_zero(normal + next.normal);
    } else if (const TangentPlane one{normal, foot}, other{next.normal, next.foot};
               meet_above(x, one, other)) {
      return normal_below_groove(x, one, other);
    } else {
      target = 0.5 * (foot + next.foot);
    }
  }
  // Where the foot is not below x on its own tangent plane, it lies on a crease: there the
  // gradient fans out.
  const Vec3 towards = foot - x;
  const double above = dot(normal, towards);
  const double aside = squared_norm(towards - above * normal);
  return above > 0 && aside <= (kCreasePixels * pixel) * (kCreasePixels * pixel)
             ? normal
             : normalized_or_zero(towards);
}

VPM_HD inline DepthSurface::Neighbors DepthSurface::neighbors_of(std::int32_t u,
                                                                 std::int32_t v) const {
  const bool in_row = u >= kAcross && u + kAcross < width;
  const bool in_column = v >= kAcross && v + kAcross < height;
  const std::int32_t i = v * width + u;
  const std::int32_t aside = in_row ? kAcross : 0, down = in_column ? kAcross * width : 0;
  return {in_row,           in_column, normals[i - aside], normals[i + aside], normals[i - down],
          normals[i + down]};
}

VPM_HD inline void DepthSurface::take_one_side(Vec3 x, const Neighbors& beside,
                                               Reading& reading) const {
  const bool in_row = beside.in_row && holds_crease(beside.left, beside.right, reading.normal),
             in_column =
                 beside.in_column && holds_crease(beside.above, beside.below, reading.normal);
  if (!in_row && !in_column) return;
  const auto i = static_cast<std::int32_t>(reading.point);
  const Vec3 foot = reading.foot;
  double least = HUGE_VAL;
  const auto consider = [&](std::int32_t j) {
    const Vec3 normal = widen(normals[j]);
    const double off = off_plane(foot, j, normal);
    if (!(off < least)) return;
    least = off;
    reading.normal = normal;
    reading.distance = dot(normal, x - foot);
  };
  for (std::int32_t side = -kAcross; side <= kAcross; side += 2 * kAcross) {
    if (in_row) consider(i + side);
    if (in_column) consider(i + side * width);
  }
}

VPM_HD inline bool DepthSurface::holds_crease(Vec3f one, Vec3f other, Vec3 normal) {
  const Vec3 before = widen(one), after = widen(other);
  return dot(before, after) < kSmoothCosine && dot(before, normal) < kSameCosine &&
         dot(after, normal) < kSameCosine;
}

VPM_HD inline double DepthSurface::off_plane(Vec3 place, std::int32_t i, Vec3 normal) const {
  const double per_depth = tiles[0][i].high;
  if (!(dot(normal, place) < 0 && std::fabs(per_depth * place.z - 1) <= kJump)) return HUGE_VAL;
  const std::int32_t v = i / width;
  return std::fabs(dot(normal, place - unproject(k, i - v * width, v, 1 / per_depth)));
}

}  // namespace vpm
