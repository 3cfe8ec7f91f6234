// The shape that a piece of the tool is taken for, known to two functions: how far it reaches
// toward a plane, and which fraction of it lies behind one.
#pragma once

#include "libvpm/core/division.h"
#include "libvpm/core/vec3.h"
#include "libvpm/scene/ball_fraction.h"

namespace vpm {

// A ball with the second moment of the piece: right to second order for any compact piece, since
// the fraction of a thin layer depends on its second moment only. Real: double, or a vector of
// such.
template <class Real>
struct BallShape {
  Real radius;

  // Returns how far the piece reaches from its middle toward a plane with this normal, m.
  [[gnu::always_inline]] VPM_HD Real reach_toward(const Vec3& /*normal*/) const { return radius; }
  // Returns the fraction of the piece that lies behind a plane which cuts it at this signed
  // distance from its middle.
  [[gnu::always_inline]] VPM_HD Real fraction_behind(const Real& distance,
                                                     const Vec3& /*normal*/) const {
    return fraction_of_cut_ball(quotient(distance, radius));
  }
};

}  // namespace vpm
