// Obstacles with exact signed distances: a camera looks at them and a tool moves into them.
//
// Distances in metres, negative inside the obstacle. Immutable; safe to share between threads.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "libvpm/core/pose.h"

namespace vpm::synthetic {

class Surface {
 public:
  virtual ~Surface() = default;

  // Returns the exact Euclidean distance to the surface, negative inside the obstacle.
  virtual double distance(Vec3 p) const = 0;

  // Returns the unit gradient of the distance, which points into free space; one of several where
  // several points of the surface are nearest.
  virtual Vec3 gradient(Vec3 p) const = 0;

  // Appends, in any order, every t at which the line origin + t * direction crosses the surface. A
  // line that only touches it may add none or two equal ones.
  virtual void crossings(Vec3 origin, Vec3 direction, std::vector<double>& t) const = 0;
};

using SurfacePtr = std::shared_ptr<const Surface>;

// Returns the half-space behind the plane through `point`; `normal` (any length) points into free
// space.
SurfacePtr make_wall(Vec3 point, Vec3 normal);

// Return a ball as obstacle, or everything outside a ball (the paper's inverted sphere).
SurfacePtr make_ball(Vec3 center, double radius);
SurfacePtr make_inverted_ball(Vec3 center, double radius);

// Returns a block with edge lengths `size`, centred at the origin of `to_world`.
SurfacePtr make_block(Vec3 size, const Pose& to_world);

// Returns an infinite prism: the polygon in x and z (simple, either orientation) extruded along y.
SurfacePtr make_prism(std::vector<std::array<double, 2>> polygon, const Pose& to_world);

// Returns the union of obstacles, which must not touch each other, else distances inside are wrong.
SurfacePtr make_union(std::vector<SurfacePtr> parts);

}  // namespace vpm::synthetic
