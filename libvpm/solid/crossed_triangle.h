// What is summed up of a triangle that the other surface crosses: the part of it inside the other
// solid. All lengths in the pair's unit.
#pragma once

#include <array>
#include <cstdint>

#include "libvpm/solid/triangle_crossing.h"
#include "libvpm/solid/wide_sum.h"

namespace vpm {

// The part of a triangle a, b, c inside is (w of c) T(a,b,c) - Σ s T(a,b,p) over the crossings p of
// edge b-c, s = +1 where the edge enters, + Σ T(a,p,q) over the segments p-q, with T the oriented
// triangle and w 1 if c is inside. The edges at a add nothing, since they pass through it.
template <class Four>
struct CrossedTriangleOf {
  std::uint32_t triangle = 0;
  std::array<Vec3, 3> corner;
  Vec3 normal;                   // unit length
  std::array<int, 3> entries{};  // of the edges: how often each enters less how often it leaves
  // What cuts it, in the pair's lists; kept for forces.
  static constexpr std::uint32_t kEnd = 0xffffffffu;
  std::uint32_t last_segment = kEnd, last_point = kEnd;

  VPM_HD void add_segment(Vec3 p, Vec3 q) { add(1, p, q); }
  VPM_HD void add_edge_crossing(const EdgeCrossing& crossing, Vec3 place) {
    entries[static_cast<std::size_t>(crossing.edge)] += crossing.sign;
    if (crossing.edge == 1) add_far_point(crossing.sign, place);
  }
  // Adds a crossing of edge b-c.
  VPM_HD void add_far_point(int sign, Vec3 place) { add(-sign, corner[1], place); }
  VPM_HD void add_corner_inside() { add(1, corner[1], corner[2]); }
  // Integrals over the part, but for w of c: 1, x, and products of x.
  VPM_HD double area() const { return sums_.real(0); }
  VPM_HD Vec3 mean() const { return {sums_.real(1), sums_.real(2), sums_.real(3)}; }
  // Returns the middle of the part, or the corner a where it has no area.
  Vec3 middle() const { return area() > 0 ? mean() / area() : corner[0]; }
  VPM_HD Products products() const {
    return {sums_.real(4), sums_.real(5), sums_.real(6),
            sums_.real(7), sums_.real(8), sums_.real(9)};
  }
  ForceMoments moments() const { return flat_force_moments(normal, area(), mean(), products()); }

 private:
  [[gnu::always_inline]] VPM_HD void add(double sign, Vec3 p, Vec3 q) {
    const double size = sign * 0.5 * dot(cross(p - corner[0], q - corner[0]), normal);
    const Vec3 mean = quotient(size, 3.0) * (corner[0] + p + q);
    const auto [four, two] = mean_product_lanes<Four>(corner[0], p, q);
    sums_.add({Four{size, mean.x, mean.y, mean.z}, size * four, size * two});
  }

  WideSums<3, Four> sums_;
};
using CrossedTriangle = CrossedTriangleOf<FourNumbers>;

}  // namespace vpm
