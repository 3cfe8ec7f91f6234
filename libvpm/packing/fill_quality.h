// How well the spheres of a packing stand for its solid: errors of inertia, gaps at the surface.
#pragma once

#include <array>
#include <vector>

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

// Gaps in metres. The gap of a point of the mesh is its distance to the nearest sphere's surface, 0
// inside a sphere.
struct SurfaceGap {
  double mean = 0;
  double p95 = 0;      // 95 % quantile over the area
  double largest = 0;  // maximum over samples and vertices, where gaps are largest
};

// Measures the gap at 50 000 points spread evenly over the area of the mesh. Needs at least one
// sphere and a solid with an extent. The same for any number of threads.
SurfaceGap surface_gap(const Solid& solid, const std::vector<Sphere>& spheres);

}  // namespace vpm
