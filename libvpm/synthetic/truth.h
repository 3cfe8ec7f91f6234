// True penetration of a solid into a surface of known distance, as reference for a measure.
#pragma once

#include "libvpm/core/pose.h"
#include "libvpm/model/solid.h"
#include "libvpm/synthetic/surface.h"

namespace vpm::synthetic {

// Integrals over the part P of the placed solid inside the obstacle; s is the signed distance and C
// the solid's centre of mass.
struct Penetration {
  double volume = 0;  // integral of 1 over P, m^3
  // Integral of grad s, m^3; the negative gradient of the energy, which is the integral of the
  // depth -s.
  Vec3 force;
  Vec3 torque;  // integral of (x - C) x grad s, m^4
  // Estimated error bound of volume and force, m^3; times radius(), of the torque.
  double error = 0;
};

inline constexpr double kTruthTolerance = 1e-6;  // relative to the solid's volume

// Solid prepared for many poses. Regions that its mesh encloses twice count twice; pass the
// enclosed_surface (outer_surface.h) of self-intersecting meshes. Immutable; safe to share between
// threads.
class TrueSolid {
 public:
  explicit TrueSolid(const Solid& solid);

  const Solid& solid() const { return solid_; }
  const MassProperties& mass() const { return mass_; }
  double radius() const { return radius_; }

  // Returns the integrals, computed over the solid's boundary, since s and so the integrands of
  // force and torque vanish on the obstacle's surface:
  //   force = int min(s, 0) n dA,  torque = int min(s, 0) (x - C) x n dA,
  //   volume = int G (a . n) dA,   G = length of the obstacle on the line along a before x.
  // Adaptive cubature of each triangle stops at an error of about `tolerance` times the volume.
  Penetration penetration(const Pose& pose, const Surface& surface,
                          double tolerance = kTruthTolerance) const;

 private:
  Solid solid_;
  MassProperties mass_;
  double radius_;
};

}  // namespace vpm::synthetic
