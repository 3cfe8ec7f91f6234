#include "libvpm/packing/inertia.h"

#include <cmath>

#include "libvpm/mesh/outer_surface.h"

namespace vpm {
namespace {

void add_outer(SecondMoments& m, double weight, Vec3 v) {
  m[0] += weight * v.x * v.x;
  m[1] += weight * v.y * v.y;
  m[2] += weight * v.z * v.z;
  m[3] += weight * v.x * v.y;
  m[4] += weight * v.x * v.z;
  m[5] += weight * v.y * v.z;
}

// Returns the Frobenius norm of the inertia tensor tr(C) 1 - C of second moments C.
double norm_of_inertia(const SecondMoments& c) {
  const double x = c[1] + c[2], y = c[0] + c[2], z = c[0] + c[1];
  return std::sqrt(x * x + y * y + z * z + 2 * (c[3] * c[3] + c[4] * c[4] + c[5] * c[5]));
}

}  // namespace

SecondMoments second_moments(const Solid& solid) {
  const Vec3 origin = mass_properties(solid).center_of_mass;
  SecondMoments sum{};
  for (const auto& [i, j, k] : solid.triangles) {
    const Vec3 a = solid.vertices[i] - origin, b = solid.vertices[j] - origin,
               c = solid.vertices[k] - origin;
    // Six times the volume of tetrahedron (origin, a, b, c).
    const double six_volumes = dot(a, cross(b, c));
    for (const Vec3 v : {a, b, c, a + b + c}) add_outer(sum, six_volumes / 120, v);
  }
  return sum;
}

InertiaError::InertiaError(const Solid& solid) {
  const Solid surface = enclosed_surface(solid);
  const MassProperties mass = mass_properties(surface);
  center_ = mass.center_of_mass;
  solid_ = second_moments(surface);
  for (double& m : solid_) m /= mass.volume;
}

void InertiaError::add(const Sphere& sphere) {
  const double v = volume(sphere), own = v * sphere.radius * sphere.radius / 5;
  add_outer(spheres_, v, sphere.center - center_);
  for (std::size_t k = 0; k < 3; ++k) spheres_[k] += own;
  volume_ += v;
}

double InertiaError::value() const {
  if (!(volume_ > 0)) return 1;
  SecondMoments difference{};
  for (std::size_t k = 0; k < difference.size(); ++k)
    difference[k] = spheres_[k] / volume_ - solid_[k];
  return norm_of_inertia(difference) / norm_of_inertia(solid_);
}

}  // namespace vpm
