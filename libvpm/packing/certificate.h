// Proof that spheres are a packing of a solid, independent of how they were found.
#pragma once

#include <vector>

#include "libvpm/mesh/outer_surface.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Metres. Violations are positive. Clearances are negative, and said up to the tolerance only: with
// no sphere, or none near another, the value is -tolerance. A sphere that is none (not finite,
// radius not positive) makes both infinite.
struct Certificate {
  double max_protrusion = 0;  // largest radius - distance to the surface; + for centres outside
  double max_overlap = 0;     // largest r_i + r_j - |c_i - c_j|
  double tolerance = 0;       // what counts as rounding
  bool holds = false;         // both are within the tolerance, and every centre is inside
};

// Tolerance of a certificate, relative to the longest side of the solid's box.
inline constexpr double kCertificateTolerance = 1e-9;

// In double precision in the solid's own coordinates: exact distances from the triangles that bound
// the solid (those of the mesh, without what lies inside), all pairs of spheres that come near each
// other, and the winding number of every centre. The tolerance grows where the solid lies so far
// from the origin that its coordinates resolve less than 1e-9 of it. `enclosure` is that of the
// solid, where it is known.
Certificate certify(const Solid& solid, const std::vector<Sphere>& spheres,
                    const Enclosure* enclosure = nullptr);

}  // namespace vpm
