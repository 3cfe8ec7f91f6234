// A bounding-volume hierarchy over triangles: closest points in logarithmic time.
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

// Four boxes per node. Box corners are floats about the box centre of the whole mesh, rounded
// outward, so that a far origin costs nothing; triangles stay in double precision.
class TriangleBvh {
 public:
  // Four lanes; GCC and clang make vector code of it on every architecture.
  using Float4 = float __attribute__((vector_size(16)));
  struct Node {
    Float4 low[3], high[3];
    // count[k] == 0: child[k] is a node (0 where the slot is empty); otherwise triangles
    // child[k] .. child[k] + count[k] of corners().
    std::uint32_t child[4], count[4];
  };
  struct Corners {
    Vec3 a, b, c;
    std::uint32_t triangle;  // its index in the mesh
  };

  // Needs at least one triangle and finite vertices; throws Error(refused) otherwise.
  TriangleBvh(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);

  // The closest surface point nearer than `within`; triangle == kNone where there is none. Exact
  // in double precision; of equally near triangles any, but always the same. Thread-safe.
  SurfacePoint closest(Vec3 x, double within = std::numeric_limits<double>::infinity()) const;

  // Triangles whose boxes come within `half` of x along every axis, as indices of corners(): the
  // first of them in `found`, the count returned. Stops counting beyond found.size().
  std::size_t around(Vec3 x, double half, std::span<std::uint32_t> found) const;

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Corners>& corners() const { return corners_; }

 private:
  struct Build;
  std::vector<Node> nodes_;  // nodes_[0] is the root
  std::vector<Corners> corners_;
  Vec3 origin_;
};

}  // namespace vpm
