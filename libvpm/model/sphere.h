// Arithmetic of spheres, and the check shared by all files with spheres.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/core/vec3.h"

namespace vpm {

inline constexpr double kPi = 3.14159265358979323846;

VPM_HD constexpr double volume(const Sphere& s) {
  return 4.0 / 3.0 * kPi * s.radius * s.radius * s.radius;
}

// Order of a packing: larger radius first, then by centre.
inline bool largest_first(const Sphere& a, const Sphere& b) {
  if (a.radius != b.radius) return a.radius > b.radius;
  if (a.center.x != b.center.x) return a.center.x < b.center.x;
  if (a.center.y != b.center.y) return a.center.y < b.center.y;
  return a.center.z < b.center.z;
}

// Throws Error(refused) if there are no spheres, too many for 32-bit indices, or one that is not
// finite, beyond kLargestLength, not positive or larger than its predecessor; the message names the
// first such sphere.
inline void check_spheres(const std::vector<Sphere>& spheres, const std::string& name) {
  if (spheres.empty()) refuse("there are no spheres", name);
  if (spheres.size() >= std::numeric_limits<std::uint32_t>::max())
    refuse("more than 2^32 - 2 spheres", name);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const Sphere& s = spheres[i];
    const auto refuse_sphere = [&](const char* defect) {
      refuse("sphere " + std::to_string(i) + " " + defect, name);
    };
    if (!is_finite(s.center) || !std::isfinite(s.radius)) refuse_sphere("is not finite");
    if (!is_in_range(s.center) || s.radius > kLargestLength)
      refuse_sphere("is further than 2^100 m from the origin, or larger");
    if (!(s.radius > 0)) refuse_sphere("has a radius that is not positive");
    if (i > 0 && s.radius > spheres[i - 1].radius)
      refuse_sphere("is larger than the one before; spheres must be largest first");
  }
}

}  // namespace vpm
