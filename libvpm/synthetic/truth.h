// The true penetration of a solid into a surface whose distance is known: what a measure should
// say.
#pragma once

#include "libvpm/core/pose.h"
#include "libvpm/model/solid.h"
#include "libvpm/synthetic/surface.h"

namespace vpm::synthetic {

// With the part P of the placed solid that lies inside of the obstacle, s the signed distance and C
// the solid's centre of mass:
struct Penetration {
  double volume = 0;  // m^3: integral of 1 over P
  Vec3 force;         // m^3: integral of grad s; minus the gradient of the energy, which is the
                      // integral of the depth -s
  Vec3 torque;        // m^4: integral of (x - C) x grad s
  double error = 0;   // estimated bound of the error of volume and force, m^3; times the reach, of
                      // the torque
};

inline constexpr double kTruthTolerance = 1e-6;  // of the solid's volume

// A solid with what repeated poses need of it. What its mesh encloses twice counts twice: give it
// enclosed_surface (outer_surface.h) of meshes that meet themselves. Immutable; safe to share
// between threads.
class TrueSolid {
 public:
  explicit TrueSolid(const Solid& solid);

  const Solid& solid() const { return solid_; }
  const MassProperties& mass() const { return mass_; }
  double reach() const { return reach_; }

  // Integrates over the solid's boundary, where s and so the integrands of force and torque vanish
  // on the obstacle's surface:
  //   force = int min(s, 0) n dA,  torque = int min(s, 0) (x - C) x n dA,
  //   volume = int G (a . n) dA,   G = length of the obstacle on the line along a before x,
  // by adaptive cubature of each triangle until the error is about `tolerance` times the volume.
  Penetration penetration(const Pose& pose, const Surface& surface,
                          double tolerance = kTruthTolerance) const;

 private:
  Solid solid_;
  MassProperties mass_;
  double reach_;
};

}  // namespace vpm::synthetic
