// Computes the parts of a ball behind planes.
#pragma once

#include "libvpm/core/host_device.h"

namespace vpm {

// Returns ball_fraction_inside() for distances within [-1, 1]. Real is double or a vector.
template <class Real>
[[gnu::always_inline]] VPM_HD constexpr Real fraction_of_cut_ball(const Real& distance) {
  const Real away = 1 - distance;
  return away * away * (2 + distance) / 4;
}

// Returns the fraction of a ball on the inner side of a plane at signed distance `distance` (in
// radii; negative where the centre is inside). Exact, monotone, 0 and 1 outside of [-1, 1].
VPM_HD constexpr double ball_fraction_inside(double distance) {
  if (distance >= 1) return 0;
  if (distance <= -1) return 1;
  return fraction_of_cut_ball(distance);
}

// Returns the fraction of a ball behind two planes that leave the given fractions; `cosine` is of
// the angle between their normals. Exact for opposite and equal planes, and for perpendicular ones
// through the centre; interpolated between these.
VPM_HD constexpr double fraction_of_both(double first, double second, double cosine) {
  const double across = first * second;
  const double apart = first + second - 1 > 0 ? first + second - 1 : 0;
  const double least = first < second ? first : second;
  return cosine < 0 ? across - cosine * (apart - across) : across + cosine * (least - across);
}

}  // namespace vpm
