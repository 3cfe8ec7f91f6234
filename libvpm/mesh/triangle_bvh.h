// Bounding volume hierarchy over triangles: closest points in logarithmic time.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/model/solid.h"

namespace vpm {

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
  Vec3 origin() const { return origin_; }  // of the boxes

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
