// Clearance of a point: the radius of the largest sphere about it that stays inside of the solid
// and outside of the spheres placed so far, with the obstacle that limits it.
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

struct Clearance {
  double value = 0;
  Obstacle nearest;
  Vec3 away;  // unit vector from the nearest point of the obstacle; zero where there is none
};

}  // namespace vpm
