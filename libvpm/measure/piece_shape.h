// Defines the shape that stands for a piece of the tool. Only its two functions know it.
#pragma once

#include "libvpm/core/division.h"
#include "libvpm/core/vec3.h"
#include "libvpm/scene/ball_fraction.h"

namespace vpm {

// Replaces a piece by the ball with its second moment. The fraction of a thin layer depends on the
// second moment only, so the ball is right to second order for any compact piece. Real is double,
// or a vector of doubles.
template <class Real>
struct BallShape {
  Real radius;

  // Returns the extent of the piece from its middle toward a plane with this normal, m.
  [[gnu::always_inline]] VPM_HD Real reach_toward(const Vec3& /*normal*/) const { return radius; }
  // Returns the fraction of the piece behind a plane that cuts it at this signed distance, m.
  [[gnu::always_inline]] VPM_HD Real fraction_behind(const Real& distance,
                                                     const Vec3& /*normal*/) const {
    return fraction_of_cut_ball(quotient(distance, radius));
  }
};

}  // namespace vpm
