// A tool held by a recorded or live haptic device through a spring and a damper, and pushed out of
// the scene by the measure.
//
// After Adams and Hannaford, "Stable Haptic Interaction with Virtual Environments" (1999): the
// device never feels the contact itself but the coupling, so what the user is rendered is bounded
// by the coupling whatever the scene does. The tool is a rigid body with the same inertia about
// every axis. Spring, damper and inertia are stepped implicitly (backward Euler), which can only
// lose energy; the contact is sampled, which can make some: an observer watches that and a
// controller takes it out again (Hannaford and Ryu, "Time-Domain Passivity Control of Haptic
// Interfaces", 2002).
//
// Units: metres, newtons, seconds, radians; world axes. Not thread-safe.
#pragma once

#include "libvpm/core/pose.h"
#include "libvpm/query/result.h"

namespace vpm {

// Rotational stiffness, damping and inertia are the linear ones times the squared radius of
// gyration.
struct CouplingParameters {
  double stiffness = 0;  // N/m
  double damping = 0;    // N s/m
  double mass = 0;       // kg
  double gyration = 0;   // m
  double rate = 1000;    // steps per second
};

// Throws Error(usage) for what is not positive and finite.
void validate(const CouplingParameters& parameters);

// The mass that the coupling moves without overshoot: damping^2 / (4 stiffness).
double critical_mass(double stiffness, double damping);

// What the parameters can stand.
struct CouplingLimits {
  double contact_stiffness = 0;  // N/m: the steps are stable against any contact softer than this
  double device_damping = 0;     // N s/m that the device itself must have to be passive at this
                                 // rate: stiffness / (2 rate) + damping (Colgate, Schenkel 1997)
};
CouplingLimits coupling_limits(const CouplingParameters& parameters);
// The lowest rate at which a contact of this stiffness is stable.
double stable_rate(const CouplingParameters& parameters, double contact_stiffness);

// Joules since the start. supplied = stored + dissipated + absorbed + lost, to rounding; `stored`
// is 0 at the start.
struct CouplingEnergy {
  double supplied = 0;    // by the device; negative: given back to the user
  double stored = 0;      // in the tool's motion and the spring
  double dissipated = 0;  // by the damper and the passivity controller
  double absorbed = 0;    // by the contact
  double lost = 0;        // by the implicit step; not negative but for rotations by large angles
};

class VirtualCoupling {
 public:
  // The tool starts at rest where the device is. Throws Error(usage) for what validate() refuses,
  // Error(refused) for a pose or a centre of mass that is not finite or not rigid.
  VirtualCoupling(const CouplingParameters& parameters, Vec3 center_of_mass, const Pose& device);

  // The tool's pose now: ask the measure here.
  Pose tool() const;

  // One step of 1 / rate: the device moves to `device`, while `contact` (N, N m about the centre of
  // mass), the measure's at tool(), pushes the tool. Returns what the user feels: force and torque
  // on the device, the torque about the tool's centre of mass as the device holds it. Throws
  // Error(refused) for a pose or a contact that is not finite or not rigid, and where the tool
  // would leave all bounds; nothing has changed then, so the next step may go on.
  Wrench advance(const Pose& device, const Wrench& contact);

  const CouplingEnergy& energy() const { return energy_; }

 private:
  double stored() const;
  Wrench step(const Pose& device, const Wrench& contact);

  CouplingParameters parameters_;
  Vec3 center_of_mass_;
  Pose device_;  // of the centre of mass
  Pose tool_;    // likewise
  Vec3 velocity_, angular_velocity_;
  CouplingEnergy energy_;
  double controlled_ = 0;  // J taken out by the passivity controller
};

}  // namespace vpm
