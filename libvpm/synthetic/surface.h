// Obstacles whose signed distance is known exactly: what a camera looks at and a tool is moved
// into.
//
// Distances are in metres, negative inside the obstacle. Immutable; safe to share between threads.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "libvpm/core/pose.h"

namespace vpm::synthetic {

class Surface {
 public:
  virtual ~Surface() = default;

  // Exact Euclidean distance to the surface, negative inside the obstacle.
  virtual double distance(Vec3 p) const = 0;

  // Gradient of the distance: unit length, points into free space. Any one of the candidates where
  // the nearest point is not unique.
  virtual Vec3 gradient(Vec3 p) const = 0;

  // Appends every t, in any order, at which the line origin + t * direction crosses the surface.
  // A line that only touches it may add none or two equal ones.
  virtual void crossings(Vec3 origin, Vec3 direction, std::vector<double>& t) const = 0;
};

using SurfacePtr = std::shared_ptr<const Surface>;

// The half-space behind the plane through `point`; `normal` (any length) points into free space.
SurfacePtr make_wall(Vec3 point, Vec3 normal);

// A ball as obstacle, and everything but a ball (the paper's inverted sphere).
SurfacePtr make_ball(Vec3 center, double radius);
SurfacePtr make_inverted_ball(Vec3 center, double radius);

// A block with edge lengths `size`, centred at the origin of `to_world`.
SurfacePtr make_block(Vec3 size, const Pose& to_world);

// A prism without ends: the polygon in x and z (simple, either sense) extruded along y.
SurfacePtr make_prism(std::vector<std::array<double, 2>> polygon, const Pose& to_world);

// Obstacles that do not touch each other (else distances inside would be wrong).
SurfacePtr make_union(std::vector<SurfacePtr> parts);

}  // namespace vpm::synthetic
