// Check shared by all files with spheres.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/model/sphere.h"

namespace vpm {

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
