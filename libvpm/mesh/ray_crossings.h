// Winding numbers of points by the triangles that a ray crosses: as exact as solid angles, and a
// ray passes few triangles. Rays all have one direction, along no axis, diagonal or plane that
// modellers like. Where rounding could decide, the caller is told and takes solid angles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/work_limit.h"
#include "libvpm/model/solid.h"

namespace vpm {

enum class Crossing { none, outward, inward, doubtful };

class RayCrossings {
 public:
  // Keeps references to both. Needs at least one triangle.
  RayCrossings(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);

  // Direction of all rays; its z is 1.
  static constexpr Vec3 kDirection{0.2718281828, 0.1414213562, 1};

  // Returns how the ray from x crosses the triangle (a, b, c). `outward` is along its normal.
  static Crossing crossing(Vec3 x, Vec3 a, Vec3 b, Vec3 c);

  // Calls visit(triangle, crossing) for all but Crossing::none. Returns the work (work_limit.h).
  // Thread-safe.
  template <class Visit>
  std::uint64_t from(Vec3 x, Visit visit) const {
    const Vec3 local = sheared(x - center_), offset = local - bvh_.origin();
    const float at[3] = {static_cast<float>(offset.x), static_cast<float>(offset.y),
                         static_cast<float>(offset.z)};
    std::uint64_t cost = 0;
    std::uint32_t stack[64] = {0};  // large enough, see TriangleBvh::closest
    for (std::size_t top = 1; top > 0;) {
      const TriangleBvh::Node& node = bvh_.nodes()[stack[--top]];
      ++cost;
      for (int slot = 0; slot < 4; ++slot) {
        const std::uint32_t child = node.child[slot], count = node.count[slot];
        if ((count == 0 && child == 0) || !passes(node, slot, at)) continue;
        if (count == 0) stack[top++] = child;
        for (std::uint32_t k = child; k < child + count; ++k) {
          cost += work::kMiss;
          if (misses(bvh_.corners()[k], local)) continue;
          const std::uint32_t triangle = bvh_.corners()[k].triangle;
          const auto& [a, b, c] = triangles_[triangle];
          const Crossing found = crossing(x, vertices_[a], vertices_[b], vertices_[c]);
          cost += work::kCrossing;
          if (found != Crossing::none) visit(triangle, found);
        }
      }
    }
    return cost;
  }

 private:
  // Maps the direction to the z axis.
  static Vec3 sheared(Vec3 p) { return {p.x - kDirection.x * p.z, p.y - kDirection.y * p.z, p.z}; }
  static bool passes(const TriangleBvh::Node& node, int slot, const float (&at)[3]) {
    return node.low[0][slot] <= at[0] && at[0] <= node.high[0][slot] &&
           node.low[1][slot] <= at[1] && at[1] <= node.high[1][slot] && at[2] <= node.high[2][slot];
  }
  // True if a sheared triangle lies beside the ray, or behind its start, beyond all rounding.
  bool misses(const TriangleBvh::Corners& t, Vec3 p) const {
    return std::max({t.a.x, t.b.x, t.c.x}) < p.x - slack_ ||
           std::min({t.a.x, t.b.x, t.c.x}) > p.x + slack_ ||
           std::max({t.a.y, t.b.y, t.c.y}) < p.y - slack_ ||
           std::min({t.a.y, t.b.y, t.c.y}) > p.y + slack_ ||
           std::max({t.a.z, t.b.z, t.c.z}) < p.z - slack_;
  }
  static std::vector<Vec3> sheared(const std::vector<Vec3>& vertices, Vec3 center);

  const std::vector<Vec3>& vertices_;
  const std::vector<Triangle>& triangles_;
  Vec3 center_;
  double slack_;  // m
  TriangleBvh bvh_;
};

}  // namespace vpm
