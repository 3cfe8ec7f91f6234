// Closest points on triangles, by a bounding volume hierarchy in logarithmic time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/model/solid.h"

namespace vpm {

// Sine of the smallest angle below which a triangle counts as its three edges: its normal is mostly
// rounding, and the error (its height) is below 1e-10 of its longest edge.
inline constexpr double kSliverSine = 1e-10;

inline Vec3 closest_point_on_segment(Vec3 x, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double length2 = squared_norm(along);
  if (!(length2 > 0)) return a;
  return a + std::clamp(dot(x - a, along) / length2, 0.0, 1.0) * along;
}

// Returns the closest point, exact up to rounding for every triangle, also degenerate ones.
inline Vec3 closest_point_on_triangle(Vec3 x, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const Vec3 normal = cross(bc, ca);
  const double normal2 = squared_norm(normal);
  const double edge2 = std::max({squared_norm(ab), squared_norm(bc), squared_norm(ca)});
  const bool flat = normal2 > kSliverSine * kSliverSine * edge2 * edge2;
  const bool beyond_ab = dot(cross(normal, ab), x - a) < 0;
  const bool beyond_bc = dot(cross(normal, bc), x - b) < 0;
  const bool beyond_ca = dot(cross(normal, ca), x - c) < 0;
  if (flat && !beyond_ab && !beyond_bc && !beyond_ca)
    return x - (dot(normal, x - a) / normal2) * normal;
  // The closest point lies on an edge that separates x from the triangle.
  Vec3 best;
  double best2 = HUGE_VAL;
  const auto take = [&](bool considered, Vec3 from, Vec3 to) {
    if (!considered && flat) return;
    const Vec3 p = closest_point_on_segment(x, from, to);
    if (const double d2 = squared_norm(x - p); d2 < best2) best2 = d2, best = p;
  };
  take(beyond_ab, a, b);
  take(beyond_bc, b, c);
  take(beyond_ca, c, a);
  return best;
}

struct SurfacePoint {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  Vec3 point;
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = kNone;
};

// Hierarchy with four boxes per node. Boxes are floats relative to the mesh's centre, rounded
// outward, so that a far origin costs nothing; triangles stay in double.
class TriangleBvh {
 public:
  // Four lanes; GCC and Clang emit vector code on every architecture.
  using Float4 = float __attribute__((vector_size(16)));
  struct Node {
    Float4 low[3], high[3];
    // If count[k] is 0, child[k] is a node (0: empty slot); otherwise the child is the triangles
    // child[k] to child[k] + count[k] of corners().
    std::uint32_t child[4], count[4];
  };
  struct Corners {
    Vec3 a, b, c;
    std::uint32_t triangle;  // index in the mesh
  };

  // Throws Error(refused) without triangles or if a vertex is not finite.
  TriangleBvh(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);

  // Returns the closest surface point nearer than `within`; triangle is kNone if there is none.
  // Exact in double; of equally near triangles the choice is arbitrary but fixed. Thread-safe.
  SurfacePoint closest(Vec3 x, double within = std::numeric_limits<double>::infinity()) const;

  // Returns the number of triangles whose boxes come within `half` of x along every axis, and
  // stores the first of them, as indices of corners(), in `found`. Counts no further than
  // found.size() + 1.
  std::size_t around(Vec3 x, double half, std::span<std::uint32_t> found) const;

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Corners>& corners() const { return corners_; }
  // Returns the origin of the boxes.
  Vec3 origin() const { return origin_; }

 private:
  struct Build;
  std::vector<Node> nodes_;  // root first
  std::vector<Corners> corners_;
  Vec3 origin_;
};

// Distance between two surfaces.

// Returns the largest distance, m, of a point of `from` to the surface `to`. Samples the vertices
// and points of triangles at most `spacing` apart, so that the true value is at most `spacing`
// larger. The maximum over both directions is the Hausdorff distance.
double farthest_from_surface(const Solid& from, const Solid& to, double spacing);

}  // namespace vpm
