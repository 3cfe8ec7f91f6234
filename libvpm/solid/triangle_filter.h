// Tells in floats, with bounds of their errors, that two triangles are apart. Most pairs whose
// boxes overlap are; the others go through the exact signs of triangle_pair.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libvpm/core/vec3.h"
#include "libvpm/core/vec3x4.h"

namespace vpm {

// Corners and edges of a triangle, side by side; the fourth lane repeats the first. Coordinates are
// at most 1 or so.
struct FilterTriangle {
  std::array<Float4, 3> corner;     // x, y, z
  std::array<Float4, 3> edge;       // from each corner to the next
  std::array<float, 3> normal;      // cross product of the edges
  float normal_size, longest_edge;  // or more
  float largest;                    // magnitude of a coordinate, or more
};

// Prepares a triangle with a normal (the cross product of its edges) in another length: both are
// scaled.
inline FilterTriangle filter_triangle(const std::array<Vec3, 3>& corners, Vec3 normal,
                                      double longest_edge, double scale) {
  constexpr double kMore = 1 + 1e-6;
  const auto lanes = [](double p, double q, double r) __attribute__((always_inline)) {
    const auto first = static_cast<float>(p);
    return Float4{first, static_cast<float>(q), static_cast<float>(r), first};
  };
  const Vec3 a = scale * corners[0], b = scale * corners[1], c = scale * corners[2];
  const Vec3 n = scale * scale * normal;
  const auto size = [](Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  return {{lanes(a.x, b.x, c.x), lanes(a.y, b.y, c.y), lanes(a.z, b.z, c.z)},
          {lanes(b.x - a.x, c.x - b.x, a.x - c.x), lanes(b.y - a.y, c.y - b.y, a.y - c.y),
           lanes(b.z - a.z, c.z - b.z, a.z - c.z)},
          {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)},
          static_cast<float>(kMore * norm(n)),
          static_cast<float>(kMore * scale * longest_edge),
          static_cast<float>(kMore * std::max({size(a), size(b), size(c)}))};
}

// Bounds of rounding errors: of the height of a corner over a plane, relative to the largest
// coordinate and the normal, and of the volume of two edges, relative to that coordinate and both
// edges. A corner is wrong by 3 units of 2^-24 of the coordinate along each axis, and what follows
// from it adds 32 and 77 units at most. Then what is lost where products underflow.
inline constexpr float kHeightError = 0x1p-19f, kVolumeError = 0x1p-17f, kUnderflow = 0x1p-120f;

// True if the triangles certainly do not meet; often false if they do not.
[[gnu::always_inline]] inline bool are_apart(const FilterTriangle& a, const FilterTriangle& b) {
  const auto product = [](const auto& u, const auto& v) __attribute__((always_inline)) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  };
  // Lanes that are certainly above or below zero.
  struct Signs {
    unsigned above, below;
  };
  const auto signs = [](const Float4& v, float error) __attribute__((always_inline)) {
    return Signs{mask_of(v > error), mask_of(v < -error)};
  };
  const auto on_one_side = [](Signs s) { return s.above == 15 || s.below == 15; };
  // Edges, as bits, with both ends on one side.
  const auto missing = [](Signs s) { return (s.above & s.above >> 1) | (s.below & s.below >> 1); };
  const float largest = std::max(a.largest, b.largest);
  std::array<Float4, 3> p, q;  // corners of a about b's first, and of b about a's
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = a.corner[k] - b.corner[k][0], q[k] = b.corner[k] - a.corner[k][0];
  const Signs of_a =
      signs(product(b.normal, p), kHeightError * largest * b.normal_size + kUnderflow);
  const Signs of_b =
      signs(product(a.normal, q), kHeightError * largest * a.normal_size + kUnderflow);
  if (on_one_side(of_a) || on_one_side(of_b)) return true;
  // On which side edges of a pass those of b, by Plücker coordinates about b's first corner, where
  // only its second edge has a moment.
  const auto& e = a.edge;
  const std::array<Float4, 3> moment{p[1] * e[2] - p[2] * e[1], p[2] * e[0] - p[0] * e[2],
                                     p[0] * e[1] - p[1] * e[0]};
  const float error = kVolumeError * largest * a.longest_edge * b.longest_edge + kUnderflow;
  const auto edge = [&](int k) __attribute__((always_inline)) {
    return std::array<float, 3>{b.edge[0][k], b.edge[1][k], b.edge[2][k]};
  };
  const Signs first = signs(product(edge(0), moment), error),
              second = signs(product(edge(1), moment) + product(b.normal, e), error),
              third = signs(product(edge(2), moment), error);
  // An edge misses a triangle that it passes on different sides of two edges.
  const unsigned of_edges_of_a = missing(of_a) | ((first.above | second.above | third.above) &
                                                  (first.below | second.below | third.below));
  const auto differ = [](Signs s) { return (s.above != 0 && s.below != 0) ? 1u : 0u; };
  const unsigned of_edges_of_b =
      missing(of_b) | differ(first) | differ(second) << 1 | differ(third) << 2;
  return (of_edges_of_a & of_edges_of_b & 7) == 7;
}

}  // namespace vpm
