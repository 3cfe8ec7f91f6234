#include "libvpm/haptics/virtual_coupling.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/core/handle.h"
#include "libvpm/core/lengths.h"
#include "libvpm/core/pose.h"

namespace vpm {

double radius_of_gyration(const ToolModel& tool) {
  constexpr double kOwnSpread = 0.6;  // mean squared distance within a sample, in squared radii
  double mean_square = 0;
  for (const CellSample& s : tool.levels.back().samples) {
    const double radius = double{s.radius};
    mean_square += s.weight * (squared_norm(widen(s.center)) + kOwnSpread * radius * radius);
  }
  // Mean moment of inertia per mass: two thirds of the mean squared distance.
  return std::sqrt(2.0 / 3 * mean_square);
}

namespace {

void check_positive(double value, const char* name) {
  if (!(value > 0 && std::isfinite(value)))
    throw Error(ErrorKind::invalid_argument,
                std::string("coupling: ") + name + " must be a positive number");
}

void check_device(const Pose& pose) {
  if (!is_rotation(pose.rotation, kRotationRounding) || !is_in_range(pose.translation))
    refuse("the device's pose is not finite, not rigid or further than 2^100 m away", "coupling");
}

// Largest contact force and torque, N and N m; beyond, squares and products with lengths would
// overflow.
constexpr double kLargestContact = 0x1p200;

// One linear or angular direction of motion: the implicit step of inertia, spring and damper.
struct Axis {
  double stiffness, damping, inertia, brake, step;

  // Returns the velocity after the step. `offset` is from the tool before its step to the device
  // after its own.
  Vec3 new_velocity(Vec3 velocity, Vec3 offset, Vec3 device_velocity, Vec3 contact) const {
    const Vec3 push = stiffness * offset + damping * device_velocity + contact;
    return (inertia * velocity + step * push) /
           (inertia + step * (damping + brake) + step * step * stiffness);
  }
};

}  // namespace

void validate(const CouplingParameters& p) {
  check_positive(p.stiffness, "stiffness (N/m)");
  check_positive(p.damping, "damping (N s/m)");
  check_positive(p.mass, "mass (kg)");
  check_positive(p.gyration, "radius of gyration (m)");
  check_positive(p.rate, "rate (Hz)");
}

double critical_mass(double stiffness, double damping) {
  return damping * damping / (4 * stiffness);
}

// Returns the limits. The step with a sampled contact c is x' = x + h v', (m + h b + h^2 k) v' = m
// v - h (k + c) x; its eigenvalues leave the unit circle at -1, where c = 4 m / h^2 + 2 b / h + k.
CouplingLimits coupling_limits(const CouplingParameters& p) {
  return {4 * p.mass * p.rate * p.rate + 2 * p.damping * p.rate + p.stiffness,
          p.stiffness / (2 * p.rate) + p.damping};
}

double stable_rate(const CouplingParameters& p, double contact_stiffness) {
  if (contact_stiffness <= p.stiffness) return 0;
  const double beyond = contact_stiffness - p.stiffness;
  return (std::sqrt(p.damping * p.damping + 4 * p.mass * beyond) - p.damping) / (4 * p.mass);
}

// Holds the state between two steps, and makes them.
class VirtualCoupling::Impl {
 public:
  Impl(const CouplingParameters& parameters, Vec3 center_of_mass, const Pose& device);

  Pose tool() const;
  Wrench advance(const Pose& device, const Wrench& contact);
  const CouplingEnergy& energy() const { return energy_; }

 private:
  double stored() const;
  Wrench step(const Pose& device, const Wrench& contact);

  CouplingParameters parameters_;
  Vec3 center_of_mass_;
  Pose device_;  // pose of the centre of mass that the device holds
  Pose tool_;    // pose of the tool's centre of mass
  Vec3 velocity_, angular_velocity_;
  CouplingEnergy energy_;
  double controlled_ = 0;  // J removed by the passivity controller
};

VirtualCoupling::Impl::Impl(const CouplingParameters& parameters, Vec3 center_of_mass,
                            const Pose& device)
    : parameters_(parameters), center_of_mass_(center_of_mass) {
  validate(parameters);
  check_device(device);
  if (!is_in_range(center_of_mass))
    refuse("the tool's centre of mass is not finite or further than 2^100 m away", "coupling");
  device_ = {device.rotation, device * center_of_mass_};
  tool_ = device_;
}

Pose VirtualCoupling::Impl::tool() const {
  return {tool_.rotation, tool_.translation - tool_.rotation * center_of_mass_};
}

double VirtualCoupling::Impl::stored() const {
  const double squared_gyration = parameters_.gyration * parameters_.gyration;
  const Vec3 stretch = device_.translation - tool_.translation;
  const Vec3 twist = rotation_vector(device_.rotation * transpose(tool_.rotation));
  return 0.5 * parameters_.mass *
             (squared_norm(velocity_) + squared_gyration * squared_norm(angular_velocity_)) +
         0.5 * parameters_.stiffness *
             (squared_norm(stretch) + squared_gyration * squared_norm(twist));
}

Wrench VirtualCoupling::Impl::advance(const Pose& device, const Wrench& contact) {
  check_device(device);
  if (!(is_within(contact.force, kLargestContact) && is_within(contact.torque, kLargestContact)))
    refuse("the contact's force or torque is not finite, or absurdly large", "coupling");
  Impl next = *this;
  const Wrench felt = next.step(device, contact);
  if (!is_finite(felt.force) || !is_finite(felt.torque) || !is_in_range(next.tool_.translation))
    refuse("the contact pushes the tool out of all bounds", "coupling", "is its stiffness stable?");
  *this = next;
  return felt;
}

Wrench VirtualCoupling::Impl::step(const Pose& device, const Wrench& contact) {
  const CouplingParameters& p = parameters_;
  const double step = 1 / p.rate, squared_gyration = p.gyration * p.gyration;
  const Pose held{device.rotation, device * center_of_mass_};
  const Vec3 moved = held.translation - device_.translation;
  const Vec3 turned = rotation_vector(held.rotation * transpose(device_.rotation));
  const Vec3 stretch = held.translation - tool_.translation;
  const Vec3 twist = rotation_vector(held.rotation * transpose(tool_.rotation));

  // Brakes the energy that the sampled contact has made out of the tool's motion, as a part of the
  // motion's energy.
  const double made = std::max(0.0, -energy_.absorbed - controlled_);
  const double motion =
      step * (squared_norm(velocity_) + squared_gyration * squared_norm(angular_velocity_));
  const double brake = motion > 0 ? std::min(made / motion, p.mass * p.rate) : 0;

  const Axis linear{p.stiffness, p.damping, p.mass, brake, step};
  const Axis angular{squared_gyration * p.stiffness, squared_gyration * p.damping,
                     squared_gyration * p.mass, squared_gyration * brake, step};
  velocity_ = linear.new_velocity(velocity_, stretch, p.rate * moved, contact.force);
  angular_velocity_ =
      angular.new_velocity(angular_velocity_, twist, p.rate * turned, contact.torque);
  const Vec3 slid = step * velocity_, rolled = step * angular_velocity_;
  tool_.translation += slid;
  tool_.rotation = rotation_from_vector(rolled) * tool_.rotation;
  device_ = held;

  // Forces of the implicit step on the tool; the device feels their opposites.
  const Vec3 slip = moved - slid, spin = turned - rolled;
  const Wrench pull{
      linear.stiffness * (stretch - slid) + (linear.damping * p.rate) * slip,
      angular.stiffness * (twist - rolled) + (angular.damping * p.rate) * spin,
  };
  const double braked =
      brake * p.rate * (squared_norm(slid) + squared_gyration * squared_norm(rolled));
  controlled_ += braked;
  energy_.supplied += dot(pull.force, moved) + dot(pull.torque, turned);
  energy_.dissipated +=
      p.rate * (linear.damping * squared_norm(slip) + angular.damping * squared_norm(spin)) +
      braked;
  energy_.absorbed -= dot(contact.force, slid) + dot(contact.torque, rolled);
  energy_.stored = stored();
  energy_.lost = energy_.supplied - energy_.stored - energy_.dissipated - energy_.absorbed;
  return {-pull.force, -pull.torque};
}

VirtualCoupling::VirtualCoupling(const CouplingParameters& parameters, Vec3 center_of_mass,
                                 const Pose& device)
    : impl_(std::make_unique<Impl>(parameters, center_of_mass, device)) {}
VirtualCoupling::~VirtualCoupling() = default;
VirtualCoupling::VirtualCoupling(VirtualCoupling&&) noexcept = default;
VirtualCoupling& VirtualCoupling::operator=(VirtualCoupling&&) noexcept = default;
VirtualCoupling::VirtualCoupling(const VirtualCoupling& other)
    : impl_(std::make_unique<Impl>(other.impl())) {}
VirtualCoupling& VirtualCoupling::operator=(const VirtualCoupling& other) {
  return *this = VirtualCoupling(other);
}

VirtualCoupling::Impl& VirtualCoupling::impl() const {
  return held_by(impl_, "VirtualCoupling");
}

Pose VirtualCoupling::tool() const {
  return impl().tool();
}

Wrench VirtualCoupling::advance(const Pose& device, const Wrench& contact) {
  return impl().advance(device, contact);
}

CouplingEnergy VirtualCoupling::energy() const {
  return impl().energy();
}

}  // namespace vpm
