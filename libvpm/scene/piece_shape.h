// Defines the shape that stands for a compact piece of the tool: how far it reaches toward a plane,
// and which fraction of it a plane leaves behind. The rest of the measure and the bodies of the
// scene ask these two functions and do not know which shape that is. Contacts also ask where the
// plane cuts it, and how much of it lies how far behind.
#pragma once

#include "libvpm/core/division.h"
#include "libvpm/core/host_device.h"

namespace vpm {

// Replaces a piece by the ball with its second moment. The fraction of a thin layer depends on the
// second moment only, so the ball is right to second order for any compact piece. Real is double,
// or a vector of doubles; Normal is a direction for each.
template <class Real>
struct BallShape {
  Real radius;

  // Returns the extent of the piece from its middle toward a plane with this normal, m.
  template <class Normal>
  [[gnu::always_inline]] VPM_HD constexpr Real reach_toward(const Normal& /*normal*/) const {
    return radius;
  }
  // Returns the fraction of the piece behind a plane that cuts it at this signed distance, m.
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real fraction_of_cut(const Real& distance,
                                                     const Normal& /*normal*/) const {
    const Real in_radii = quotient(distance, radius), away = 1 - in_radii;
    return away * away * (2 + in_radii) / 4;
  }
  // Returns how fast that fraction grows as the plane rises, 1/m: the area in which the plane cuts
  // the piece, in parts of its volume.
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real section_of_cut(const Real& distance,
                                                    const Normal& /*normal*/) const {
    const Real in_radii = quotient(distance, radius);
    return quotient(3 * (1 - in_radii) * (1 + in_radii), 4 * radius);
  }
  // Returns how far the part behind lies behind the piece's middle, along the normal, times the
  // fraction that it is, m.
  template <class Normal>
  [[gnu::always_inline]] VPM_HD Real moment_of_cut(const Real& distance,
                                                   const Normal& /*normal*/) const {
    const Real in_radii = quotient(distance, radius), section = (1 - in_radii) * (1 + in_radii);
    return 3 * radius * section * section / 16;
  }
};
// The shape of all pieces: to try another one, name it here.
template <class Real>
using PieceShape = BallShape<Real>;

// Returns the fraction of a piece behind a plane with this normal at this signed distance, m, from
// the piece's middle: 0 where the plane has all of it before it, 1 where it has all of it behind.
template <class Shape, class Normal>
VPM_HD double fraction_behind(const Shape& shape, double distance, const Normal& normal) {
  const double reach = shape.reach_toward(normal);
  if (distance >= reach) return 0;
  if (distance <= -reach) return 1;
  return shape.fraction_of_cut(distance, normal);
}

}  // namespace vpm
