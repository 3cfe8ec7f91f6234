// DepthSurface: where the surface in a ball is one plane.
#pragma once

#include "libvpm/surface/depth_surface.h"

namespace vpm {

template <class Read>
VPM_HD bool DepthSurface::is_flat(const Look& look, const Read& read, double tolerance,
                                  TangentPlane& plane) const {
  const Reading reading = read();
  if (!reading.known) return false;
  const CornerNormals corners = corner_normals(look);  // soon, though they may not be needed
  plane = {reading.normal, reading.foot};
  if (!shows(look, plane, tolerance)) return false;
  plane.normal = mean_normal(look, corners, reading.normal);
  return true;
}

VPM_HD inline bool DepthSurface::shows(const Look& look, const TangentPlane& plane,
                                       double tolerance) const {
  if (spans_few_pixels(look)) return look.range.high - look.range.low <= kJump * look.range.high;
  const double per_height = quotient(1, dot(plane.normal, plane.foot));
  const double per_u = quotient(plane.normal.x * per_height, k.fx);
  const double per_v = quotient(plane.normal.y * per_height, k.fy);
  const PixelRectangle& t = look.tiles;
  const double u = 0.5 * (t.u0 + t.u1) - k.cx, v = 0.5 * (t.v0 + t.v1) - k.cy;
  const double middle = per_u * u + per_v * v + plane.normal.z * per_height;
  const double spread = 0.5 * (std::fabs(per_u) * (t.u1 - t.u0) + std::fabs(per_v) * (t.v1 - t.v0));
  const double allowed = quotient(tolerance, plane.foot.z * plane.foot.z);
  return std::fabs(middle - spread - look.range.low) <= allowed &&
         std::fabs(middle + spread - look.range.high) <= allowed;
}

VPM_HD inline DepthSurface::PlacesAround::PlacesAround(const Reading& middle, Vec3 center,
                                                       double radius)
    : below(center - middle.distance * middle.normal) {
  const Vec3 n = middle.normal;
  const Vec3 axis = std::fabs(n.x) < std::fabs(n.y) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  side = kRim * radius * normalized_or_zero(cross(n, axis));
  other = cross(n, side);
}

VPM_HD inline bool DepthSurface::PlaneMean::take(const Reading& reading) {
  if (!reading.known || dot(reading.normal, middle_normal) < kSmoothCosine) return false;
  direction += reading.normal;
  feet += reading.foot;
  return true;
}

template <class ReadAll>
VPM_HD bool DepthSurface::mean_plane(const Look& look, Vec3 center, double radius, double tolerance,
                                     const ReadAll& read_all, TangentPlane& plane) const {
  if (!may_be_flat(look)) return false;
  const Reading middle = read(center);
  if (!middle.known) return false;
  const PlacesAround around(middle, center, radius);
  const Vec3 places[PlacesAround::kCount] = {around.at(0), around.at(1), around.at(2),
                                             around.at(3)};
  PlaneMean mean(middle);
  if (!read_all(*this, places, [&](const Reading& reading) { return mean.take(reading); }))
    return false;
  plane = mean.plane();
  return shows(look, plane, tolerance);
}

VPM_HD inline DepthSurface::CornerNormals DepthSurface::corner_normals(const Look& look) const {
  const PixelRectangle& p = look.pixels;
  const std::int32_t u = (p.u1 - p.u0) / 4, v = (p.v1 - p.v0) / 4;
  const std::int32_t above = (p.v0 + v) * width, below = (p.v1 - v) * width;
  return {{normals[above + p.u0 + u], normals[above + p.u1 - u], normals[below + p.u0 + u],
           normals[below + p.u1 - u]}};
}

VPM_HD inline Vec3 DepthSurface::mean_normal(const Look& look, const CornerNormals& corners,
                                             Vec3 middle) const {
  if (spans_few_pixels(look)) return middle;
  Vec3 sum = middle;
  for (const Vec3f& corner : corners.at) {
    const Vec3 normal = widen(corner);
    if (dot(normal, middle) > kSmoothCosine) sum += normal;
  }
  return normalized_or_zero(sum);
}

}  // namespace vpm
