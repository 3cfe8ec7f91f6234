// Finds the plane that stands for a smooth surface across a ball. Queries of a depth image and the
// calibration of a tool model take it from here, so that the model states the error queries make.
#pragma once

#include "libvpm/scene/body.h"

namespace vpm {

// Part of a ball's radius at which a surface is sampled about the ball's middle: there a paraboloid
// is as high as its mean over a box in the ball.
inline constexpr double kRim = 0.5;

// Returns in `plane` the mean of five samples of a surface: at the middle of a ball, and at four
// places about the foot of that, on its tangent plane. Returns false if one is unknown, or if a
// normal about the middle has a cosine below `smooth` with that at the middle. `sample_all` is
// SampleInTurn, or samples the same places side by side.
template <class Surface, class SampleAll>
VPM_HD bool mean_of_five(const Surface& surface, Vec3 center, double radius, double smooth,
                         const SampleAll& sample_all, TangentPlane& plane) {
  const SurfaceSample middle = sample_all.middle(surface, center);
  if (!middle.known) return false;
  const Vec3 n = middle.normal, below = center - middle.distance * n;
  const Vec3 side = kRim * radius * normalized_or_zero(cross(n, axis_aside(n))),
             other = cross(n, side);
  const Vec3 places[] = {below + side, below - side, below + other, below - other};
  Vec3 direction = n, feet = middle.foot;
  const auto take = [&](const SurfaceSample& on_surface) {
    if (!on_surface.known || dot(on_surface.normal, n) < smooth) return false;
    direction += on_surface.normal;
    feet += on_surface.foot;
    return true;
  };
  if (!sample_all(surface, places, take)) return false;
  plane = {normalized_or_zero(direction), 0.2 * feet};
  return true;
}

}  // namespace vpm
