// Solids of the tests of pairs, prepared, and what their truth is made of.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <utility>

#include "libvpm/core/pose.h"
#include "libvpm/mesh/outer_surface.h"
#include "libvpm/solid/solid_pair.h"

namespace vpm::test {

inline std::shared_ptr<const SolidSurface> surface(const Solid& solid, bool with_depth = false) {
  const Enclosure enclosure = enclosure_of(solid);
  return std::make_shared<SolidSurface>(enclosure.surface ? *enclosure.surface : solid, with_depth);
}

inline Pose at(Vec3 place) {
  return {{}, place};
}

// Returns a motion with a random rotation and a place in a cube of this half edge.
inline Pose random_pose(std::mt19937_64& random, double half) {
  std::uniform_real_distribution<double> place(-half, half), turn(-2, 2);
  const Vec3 by{turn(random), turn(random), turn(random)};
  return {exact_rotation(rotation_from_vector(by)), {place(random), place(random), place(random)}};
}

inline Solid moved(Solid solid, const Pose& pose) {
  for (Vec3& v : solid.vertices) v = pose * v;
  return solid;
}

// Adds the shells of one solid, moved by so many metres, to those of another.
inline void append(Solid& solid, const Solid& more, Vec3 by = {}) {
  const auto first = static_cast<std::uint32_t>(solid.vertices.size());
  for (const Vec3& v : more.vertices) solid.vertices.push_back(v + by);
  for (const auto& [a, b, c] : more.triangles)
    solid.triangles.push_back({first + a, first + b, first + c});
}
// Turns a solid inside out: the wall of a hollow.
inline Solid turned(Solid solid) {
  for (Triangle& t : solid.triangles) std::swap(t[1], t[2]);
  return solid;
}

// Returns volume and centroid of what two convex solids share, by cutting each face of one by the
// half-spaces of the other. Their faces must not lie in a common plane.
MassProperties convex_intersection(const Solid& a, const Solid& b);

// Returns the part of a polygon below the planes of a convex solid's faces.
std::vector<Vec3> clipped(std::vector<Vec3> polygon, const Solid& convex);

}  // namespace vpm::test
