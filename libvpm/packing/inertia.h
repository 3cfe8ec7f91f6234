// Error of spheres as a model of a solid's inertia.
#pragma once

#include <array>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Integral of x x^T about a point: xx, yy, zz, xy, xz, yz; m^5.
using SecondMoments = std::array<double, 6>;

// Returns the exact moments about the solid's centre of mass. Regions enclosed twice count twice;
// enclosed_surface (outer_surface.h) avoids that.
SecondMoments second_moments(const Solid& solid);

// Relative error of the inertia tensor, |I_spheres - I_solid| / |I_solid| in the Frobenius norm.
// Tensors are about the solid's centre of mass and divided by volume, so that spheres and solid
// have the same mass. The error covers principal moments, axes and, through the common point, the
// centre of mass; missing volume is the coverage's concern.
class InertiaError {
 public:
  explicit InertiaError(const Solid& solid);  // regions enclosed twice count once
  void add(const Sphere& sphere);
  double value() const;  // 1 without spheres

 private:
  Vec3 center_;
  SecondMoments solid_{}, spheres_{};  // solid_ is divided by its volume
  double volume_ = 0;                  // volume of the spheres
};

}  // namespace vpm
