// Tool held by a recorded or live haptic device through a spring and a damper, and pushed out of
// the scene by the measured contact.
//
// After Adams and Hannaford, "Stable Haptic Interaction with Virtual Environments" (1999): the
// device feels the coupling and never the contact itself, so the coupling bounds what the user
// feels whatever the scene does. The tool is a rigid body with equal inertia about all axes.
// Spring, damper and inertia are stepped implicitly (backward Euler), which can only lose energy.
// The contact is sampled, which can make energy; an observer measures that and a controller removes
// it (Hannaford and Ryu, "Time-Domain Passivity Control of Haptic Interfaces", 2002).
//
// Units: metres, newtons, seconds, radians; world axes. Not thread-safe.
#pragma once

#include <vpm/error.h>
#include <vpm/export.h>
#include <vpm/pose.h>
#include <vpm/query_types.h>

#include <memory>

namespace vpm {

// Rotational stiffness, damping and inertia are the linear ones times gyration^2.
struct CouplingParameters {
  double stiffness = 0;  // N/m
  double damping = 0;    // N s/m
  double mass = 0;       // kg
  double gyration = 0;   // radius of gyration, m
  double rate = 1000;    // steps per second
};

// Throws Error(invalid_argument) if a parameter is not positive and finite.
VPM_API void validate(const CouplingParameters& parameters);

// Returns the mass, kg, that the coupling moves without overshoot: damping^2 / (4 stiffness).
VPM_API double critical_mass(double stiffness, double damping);

// Limits that a coupling's parameters imply.
struct CouplingLimits {
  double contact_stiffness = 0;  // N/m; steps are stable for contacts softer than this
  // N s/m; the device must have this damping to be passive at this rate: stiffness / (2 rate) +
  // damping (Colgate, Schenkel 1997).
  double device_damping = 0;
};
VPM_API CouplingLimits coupling_limits(const CouplingParameters& parameters);
// Returns the lowest rate, 1/s, at which a contact of this stiffness (N/m) is stable.
VPM_API double stable_rate(const CouplingParameters& parameters, double contact_stiffness);

// Energies in joules since the start. supplied = stored + dissipated + absorbed + lost, to
// rounding; `stored` is 0 at the start.
struct CouplingEnergy {
  double supplied = 0;    // work of the device; negative if given back to the user
  double stored = 0;      // energy of the tool's motion and of the spring
  double dissipated = 0;  // energy taken by damper and passivity controller
  double absorbed = 0;    // energy taken by the contact
  double lost = 0;        // to the implicit step; >= 0 except for rotations by large angles
};

// A copy goes its own way: it may be stepped ahead to see what would be.
class VPM_API VirtualCoupling {
 public:
  // Starts with the tool at rest at the device's pose. Throws Error(invalid_argument) for
  // parameters that validate() refuses, Error(refused) for a pose or a centre of mass that is not
  // finite or not rigid.
  VirtualCoupling(const CouplingParameters& parameters, Vec3 center_of_mass, const Pose& device);
  ~VirtualCoupling();
  VirtualCoupling(VirtualCoupling&&) noexcept;
  VirtualCoupling& operator=(VirtualCoupling&&) noexcept;
  VirtualCoupling(const VirtualCoupling&);
  VirtualCoupling& operator=(const VirtualCoupling&);

  // Returns the tool's current pose, at which the contact is to be measured.
  Pose tool() const;

  // Makes a step of 1 / rate: the device moves to `device` while `contact` (N; N m about the centre
  // of mass; measured at tool()) pushes the tool. Returns force and torque on the device, i.e. what
  // the user feels; the torque is about the tool's centre of mass as the device holds it. Throws
  // Error(refused) if pose or contact is not finite or not rigid, or if the tool would leave all
  // bounds. The state is then unchanged, so the next step may go on.
  Wrench advance(const Pose& device, const Wrench& contact);

  // Returns the energies since the start.
  CouplingEnergy energy() const;

 private:
  class Impl;
  Impl& impl() const;

  std::unique_ptr<Impl> impl_;  // null once moved from
};

}  // namespace vpm
