// Computes squared distances of four boxes, and of up to four points, by vectors. For host files
// that are compiled for several vector widths (core/lanes.h).
#pragma once

#include <cstring>
#include <span>

#include "libvpm/core/vec3x4.h"
#include "libvpm/scene/points/point_tree.h"

namespace vpm {

[[gnu::always_inline]] inline Double4 load_four(const float* from) {
  Float4 four;
  std::memcpy(&four, from, sizeof four);
  return widen(four);
}

struct PointTree::ByVectors {
  [[gnu::always_inline]] static void to_boxes(const BoxQuad& quad, Vec3 x, double (&squared)[4]) {
    const double at[3] = {x.x, x.y, x.z};
    Double4 sum{};
    for (int axis = 0; axis < 3; ++axis) {
      const Double4 before = load_four(quad.low[axis]) - at[axis],
                    after = at[axis] - load_four(quad.high[axis]), zero{};
      const Double4 gap = before > after ? before : after;
      sum += gap > 0 ? gap * gap : zero;
    }
    std::memcpy(squared, &sum, sizeof sum);
  }
  [[gnu::always_inline]] static void to_points(const Vec3f* points, std::uint32_t count, Vec3 x,
                                               double (&squared)[4]) {
    const auto [a, b, c, d] = four_of(std::span(points, count), 0);
    const Double4 all = squared_norm(Vec3x4(a, b, c, d) - Vec3x4(x, x, x, x));
    std::memcpy(squared, &all, sizeof all);
  }
};

}  // namespace vpm
