// What is summed up of a triangle that the other surface crosses: the part of it inside the other
// solid. All lengths in the pair's unit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libvpm/solid/triangle_crossing.h"
#include "libvpm/solid/wide_sum.h"

namespace vpm {

// The part of a triangle a, b, c inside is Σ T(o,p,q) over the segments p-q + Σ over the edges u-v
// of (w of v) T(o,m,v) - (w of u) T(o,m,u) - Σ s T(o,m,p) over the edge's crossings p, s = +1 where
// it enters, with T the oriented triangle, w 1 for corners inside, and any o in the plane and m on
// the edge. From o = a, and m = b on edge b-c, only c and the crossings of b-c add anything.
//
// The origin is the smaller solid's centre of mass. Where a corner is much farther from it than
// that solid is large, triangles that begin at the corner are so large that their sum has no digits
// left. Then o is the point of the plane nearest to the origin, and m that of each edge.
template <class Four>
struct CrossedTriangleOf {
  std::uint32_t triangle = 0;
  std::array<Vec3, 3> corner;
  Vec3 normal;                   // unit length
  std::array<int, 3> entries{};  // of the edges: how often each enters less how often it leaves
  // What cuts it, in the pair's lists; kept for forces.
  static constexpr std::uint32_t kEnd = 0xffffffffu;
  std::uint32_t last_segment = kEnd, last_point = kEnd;

  // Takes the corners and the normal before anything is added.
  VPM_HD void set_corners(const std::array<Vec3, 3>& corners, Vec3 unit_normal) {
    corner = corners, normal = unit_normal;
    double most = 0;
    for (const Vec3& c : corners)
      most = std::max({most, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    is_far_ = most > 1;
    from_ = is_far_ ? dot(normal, corner[0]) * normal : corner[0];
  }
  // Whether a corner is farther away than the unit. None is where solids are alike in size.
  VPM_HD bool is_far() const { return is_far_; }
  VPM_HD Vec3 from() const { return from_; }  // o
  // Calls take(sign, p, q) for each oriented triangle T(o,p,q), as above, that a crossing of an
  // edge at a place adds to the part. for_corner() does so for corner k, which is inside.
  template <class Take>
  [[gnu::always_inline]] VPM_HD void for_crossing(unsigned edge, int sign, Vec3 place,
                                                  const Take& take) const {
    if (is_far_)
      take(-sign, near_place(edge), place);
    else if (edge == 1)
      take(-sign, corner[1], place);
  }
  template <class Take>
  [[gnu::always_inline]] VPM_HD void for_corner(unsigned k, const Take& take) const {
    if (is_far_) {
      take(1, near_place((k + 2) % 3), corner[k]);
      take(-1, near_place(k), corner[k]);
    } else if (k == 2) {
      take(1, corner[1], corner[2]);
    }
  }

  VPM_HD void add_segment(Vec3 p, Vec3 q) { add(1, p, q); }
  // Adds a crossing of an edge, of sign as EdgeCrossing::sign.
  VPM_HD void add_crossing(unsigned edge, int sign, Vec3 place) {
    for (unsigned k = 0; k < 3; ++k) entries[k] += k == edge ? sign : 0;
    for_crossing(edge, sign, place, [&](double s, Vec3 p, Vec3 q) { add(s, p, q); });
  }
  VPM_HD void add_corner_inside(unsigned k) {
    for_corner(k, [&](double s, Vec3 p, Vec3 q) { add(s, p, q); });
  }
  // Adds the corners inside, after all crossings, which tell of the others what is known of c.
  VPM_HD void add_corners_inside(bool is_last_inside) {
    if (is_last_inside) add_corner_inside(2);
    if (!is_far_) return;
    const int last = is_last_inside ? 1 : 0;
    if (last + entries[2] > 0) add_corner_inside(0);
    if (last - entries[1] > 0) add_corner_inside(1);
  }
  // Integrals over the part: 1, x, and products of x.
  VPM_HD double area() const { return sums_.real(0); }
  VPM_HD Vec3 mean() const { return {sums_.real(1), sums_.real(2), sums_.real(3)}; }
  // Returns the middle of the part, or o where it has no area.
  Vec3 middle() const { return area() > 0 ? mean() / area() : from_; }
  VPM_HD Products products() const {
    return {sums_.real(4), sums_.real(5), sums_.real(6),
            sums_.real(7), sums_.real(8), sums_.real(9)};
  }
  ForceMoments moments() const { return flat_force_moments(normal, area(), mean(), products()); }

 private:
  // Returns the place of an edge next to the origin.
  VPM_HD Vec3 near_place(unsigned edge) const {
    const Vec3 u = corner[edge], along = corner[(edge + 1) % 3] - u;
    const double length2 = squared_norm(along);
    return length2 > 0 ? u - quotient(dot(u, along), length2) * along : u;
  }
  [[gnu::always_inline]] VPM_HD void add(double sign, Vec3 p, Vec3 q) {
    const double size = sign * 0.5 * dot(cross(p - from_, q - from_), normal);
    const Vec3 mean = quotient(size, 3.0) * (from_ + p + q);
    const auto [four, two] = mean_product_lanes<Four>(from_, p, q);
    sums_.add({Four{size, mean.x, mean.y, mean.z}, size * four, size * two});
  }

  WideSums<3, Four> sums_;
  Vec3 from_;
  bool is_far_ = false;
};
using CrossedTriangle = CrossedTriangleOf<FourNumbers>;

}  // namespace vpm
