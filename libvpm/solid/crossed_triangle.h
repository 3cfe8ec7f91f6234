// What is summed up of a triangle that the other surface crosses: the part of it inside the other
// solid. All lengths in the pair's unit.
#pragma once

#include <array>
#include <cstdint>

#include "libvpm/solid/triangle_pair.h"
#include "libvpm/solid/wide_sum.h"

namespace vpm {

// The part of a triangle a, b, c inside is (w of c) T(a,b,c) - Σ s T(a,b,p) over the crossings p of
// edge b-c, s = +1 where the edge enters, + Σ T(a,p,q) over the segments p-q, with T the oriented
// triangle and w 1 if c is inside. The edges at a add nothing, since they pass through it.
struct CrossedTriangle {
  std::uint32_t triangle = 0;
  std::array<Vec3, 3> corner;
  Vec3 normal;  // unit length
  // Integrals over the part, but for w of c: 1, x, and products of x.
  WideSum area;
  WideVec3 mean;
  std::array<WideSum, 6> products;
  std::array<int, 3> entries{};  // of the edges: how often each enters less how often it leaves
  // What cuts it, in the pair's lists; kept for forces.
  static constexpr std::uint32_t kEnd = 0xffffffffu;
  std::uint32_t last_segment = kEnd, last_point = kEnd;

  void add(double sign, Vec3 p, Vec3 q) {
    const double size = sign * 0.5 * dot(cross(p - corner[0], q - corner[0]), normal);
    area.add(size);
    mean.add(size / 3 * (corner[0] + p + q));
    const Products products_of = mean_products(corner[0], p, q);
    for (std::size_t k = 0; k < 6; ++k) products[k].add(size * products_of[k]);
  }
  void add_segment(Vec3 p, Vec3 q) { add(1, p, q); }
  void add_edge_crossing(const EdgeCrossing& crossing, Vec3 place) {
    entries[static_cast<std::size_t>(crossing.edge)] += crossing.sign;
    if (crossing.edge == 1) add_far_point(crossing.sign, place);
  }
  // Adds a crossing of edge b-c.
  void add_far_point(int sign, Vec3 place) { add(-sign, corner[1], place); }
  void add_corner_inside() { add(1, corner[1], corner[2]); }
  Products products_real() const {
    Products p{};
    for (std::size_t k = 0; k < 6; ++k) p[k] = products[k].real();
    return p;
  }
  ForceMoments moments() const {
    return flat_force_moments(normal, area.real(), mean.real(), products_real());
  }
};

}  // namespace vpm
