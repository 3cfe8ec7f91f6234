// How well spheres stand for a solid where dynamics is concerned.
#pragma once

#include <array>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Integral of x x^T about a point: xx, yy, zz, xy, xz, yz; m^5.
using SecondMoments = std::array<double, 6>;

// About the solid's centre of mass, exactly; what the mesh encloses twice counts twice (see
// enclosed_surface in outer_surface.h).
SecondMoments second_moments(const Solid& solid);

// Inertia tensors about the solid's centre of mass, each divided by its volume, so that spheres and
// solid have the same mass: |I_spheres - I_solid| / |I_solid|, in the Frobenius norm. It covers the
// principal moments, their axes and, by the common point, the centre of mass. No packing covers
// everything: the volume that is missing is counted by the coverage, not here.
class InertiaError {
 public:
  explicit InertiaError(const Solid& solid);  // what it encloses twice counts once
  void add(const Sphere& sphere);
  double value() const;  // 1 without spheres

 private:
  Vec3 center_;
  SecondMoments solid_{}, spheres_{};  // the solid's per volume
  double volume_ = 0;                  // of the spheres
};

}  // namespace vpm
