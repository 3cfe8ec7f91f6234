// Proof that spheres are a packing of a solid, independent of how they were found.
#pragma once

#include <string>
#include <vector>

#include "libvpm/mesh/outer_surface.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Lengths in metres; violations are positive, clearances negative. Values are clamped at
// -tolerance, which is also the value without a sphere or without neighbours. A sphere that is not
// finite or not positive makes both infinite.
struct Certificate {
  // Largest radius - distance to the surface; + distance for centres outside.
  double max_protrusion = 0;
  double max_overlap = 0;  // largest r_i + r_j - |c_i - c_j|
  double tolerance = 0;    // violations up to this are rounding
  // True if both are within the tolerance and every centre is inside.
  bool holds = false;
};

// Tolerance of a certificate, relative to the longest side of the solid's bounding box.
inline constexpr double kCertificateTolerance = 1e-9;

// Returns the certificate, computed in double in the solid's own coordinates: exact distances from
// the triangles that bound the solid (without mesh parts in its interior), all pairs of nearby
// spheres, and the winding number of every centre. The tolerance grows if the solid is so far from
// the origin that its coordinates resolve less than 1e-9 of it. `enclosure` is that of the solid,
// or null to compute it.
Certificate certify(const Solid& solid, const std::vector<Sphere>& spheres,
                    const Enclosure* enclosure = nullptr);

// Throws Error(refused), naming `name`, unless the certificate holds and `coverage`, the spheres'
// volume / the solid's, is at most 1 to its tolerance: more shows that the mesh crosses itself.
void refuse_uncertified(const std::string& name, double coverage, const Certificate& certificate);

}  // namespace vpm
