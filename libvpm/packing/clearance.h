// Clearance of a point: radius of the largest sphere about it inside the solid and outside the
// spheres placed so far, with the obstacle that limits it.
#pragma once

#include <cstdint>

#include "libvpm/core/vec3.h"

namespace vpm {

struct Obstacle {
  enum class Kind : std::uint8_t { none, triangle, sphere };
  Kind kind = Kind::none;
  std::uint32_t index = 0;
  friend constexpr bool operator==(const Obstacle&, const Obstacle&) = default;
};

struct SeparationBound {
  double value = 0;
  Obstacle nearest;
  // Unit vector from the nearest point of the obstacle; zero if there is none.
  Vec3 away;
};

}  // namespace vpm
