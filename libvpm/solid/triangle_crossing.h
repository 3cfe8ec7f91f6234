// How two triangles of different surfaces meet, for one pair or four side by side, on host and
// device: what doubles tell of their signs, and exact signs where these leave one open.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "libvpm/core/pose.h"
#include "libvpm/core/vector_width.h"
#include "libvpm/mesh/exact_sign.h"

namespace vpm {

// Triangle in the frame of both surfaces. `index` orders its vertices as all triangles of its
// surface do.
struct PlacedTriangle {
  std::array<Vec3, 3> corner;
  Vec3 normal;          // cross product of its edges: twice the area vector
  double longest_edge;  // or more
  std::array<std::uint32_t, 3> index;
};

// What doubles tell of a pair of triangles a, b: heights of corners over the other's plane, times
// twice its area, and the signs of these and of the volumes of pairs of edges, in bits. Bit k
// stands for a's corner k over b's plane, 3 + k for b's corner over a's, and 6 + 3 i + j for the
// edges i of a and j of b. Of a sign that rounding leaves open neither bit is set.
struct PairSigns {
  std::array<double, 3> above_b, above_a;
  unsigned above, below;
};

// Point where an edge of one triangle, from corner `edge` to the next, passes through the other.
struct EdgeCrossing {
  int edge = 0;
  int sign = 0;  // +1: the edge goes into the other solid, -1: it leaves that
  // The same bits for all triangles that share the edge, and for both roles.
  Vec3 place;
};

enum class Meeting {
  apart,
  crossing,
  // Signs are zero or contradict each other: the surfaces are not in general position.
  undecided
};

struct TriangleCrossing {
  // Ends of the common segment, in the direction in which it bounds the part of the first triangle
  // inside the other solid, counter-clockwise seen from outside.
  Vec3 start, end;
  // Crossings of edges of the first and of the second; one of the two ends each.
  std::array<EdgeCrossing, 2> of_first, of_second;
  int first_count = 0, second_count = 0;
};

// Returns a triangle whose corners are given in the frame of both surfaces.
VPM_HD inline PlacedTriangle placed_triangle(const std::array<Vec3, 3>& corners,
                                             double longest_edge,
                                             const std::array<std::uint32_t, 3>& index) {
  const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  return {corners, normal, longest_edge, index};
}

// Rounding error of the determinants here, by far, relative to the cube of the largest distance of
// two corners: each is a sum of two dozen products of three differences.
inline constexpr double kDeterminantError = 3e-14;
// The corners of two triangles with overlapping boxes are within so many times the sum of their
// longest edges: the root of three for boxes, and their padding.
inline constexpr double kSpread = 1.8;
// First bits, in PairSigns, of the heights of b's corners and of the pairs of edges.
inline constexpr unsigned kHeightsOfB = 3, kEdges = 6;

// What the tests of a pair of triangles share, or of four.
template <class Real>
struct PairTests {
  using Place = PlaceOf<Real>;
  std::array<Place, 3> a, b;             // corners, about the first of b
  std::array<Real, 3> above_b, above_a;  // heights of a's corners over b's plane, and of b's
  Real bound;                            // of errors of determinants

  // Takes corners, normals, and sums of the longest edges of both.
  [[gnu::always_inline]] VPM_HD PairTests(const std::array<Place, 3>& of_a, const Place& normal_a,
                                          const std::array<Place, 3>& of_b, const Place& normal_b,
                                          const Real& longest) {
    for (std::size_t k = 0; k < 3; ++k) {
      a[k] = of_a[k] - of_b[0], b[k] = of_b[k] - of_b[0];
      above_b[k] = dot(normal_b, a[k]);
      above_a[k] = dot(normal_a, of_b[k] - of_a[0]);
    }
    const Real spread = kSpread * longest;
    bound = kDeterminantError * (spread * spread * spread);
  }
};

// Signs of a pair in the bits of PairSigns, or of four.
template <class Bits>
struct SignBits {
  Bits above{}, below{};

  template <class Real>
  [[gnu::always_inline]] VPM_HD void set(unsigned bit, const Real& value, const Real& bound) {
    above |= bits_where(value > bound, 1U << bit);
    below |= bits_where(value < -bound, 1U << bit);
  }
};

// Returns the signs that doubles tell.
template <class Bits, class Real>
[[gnu::always_inline]] VPM_HD inline SignBits<Bits> signs_of(const PairTests<Real>& pair) {
  SignBits<Bits> signs;
  const auto& a = pair.a;
  const auto& b = pair.b;
  for (unsigned k = 0; k < 3; ++k) {
    signs.set(k, pair.above_b[k], pair.bound);
    signs.set(kHeightsOfB + k, pair.above_a[k], pair.bound);
  }
  // Plücker coordinates tell on which side edges of a pass those of b. About b's first corner only
  // b's second edge has a moment, and the volumes of one edge of a add up to what it rises.
  for (unsigned i = 0; i < 3; ++i) {
    const unsigned next = (i + 1) % 3, bit = kEdges + 3 * i;
    const PlaceOf<Real> moment = cross(a[i], a[next]);
    const Real first = dot(moment, b[1]), third = -dot(moment, b[2]);
    signs.set(bit, first, pair.bound);
    signs.set(bit + 1, pair.above_b[next] - pair.above_b[i] - first - third, pair.bound);
    signs.set(bit + 2, third, pair.bound);
  }
  return signs;
}

// The following take the signs of one pair or of four, and return bits 0 to 2 for the edges of a
// triangle.

// Returns the edges of which both ends are among three bits.
template <class Bits>
[[gnu::always_inline]] VPM_HD inline Bits edges_within(const Bits& corners) {
  return corners & (corners >> 1 | corners << 2) & 7;
}
// Returns the edges of a of which any, or all, volumes with edges of b are set.
template <class Bits>
[[gnu::always_inline]] VPM_HD inline Bits edges_of_a(const Bits& signs, bool any) {
  const Bits e = signs >> kEdges;
  const Bits rows = (any ? e | e >> 1 | e >> 2 : e & e >> 1 & e >> 2) & 0x49;  // bits 0, 3 and 6
  return (rows | rows >> 2 | rows >> 4) & 7;
}
// Returns the same of b with edges of a.
template <class Bits>
[[gnu::always_inline]] VPM_HD inline Bits edges_of_b(const Bits& signs, bool any) {
  const Bits e = signs >> kEdges;
  return (any ? e | e >> 3 | e >> 6 : e & e >> 3 & e >> 6) & 7;
}

// Returns the edges of a, and of b, that miss the other triangle: both ends lie on one side, or it
// passes on different sides of two edges. Where both have all three, the pair is apart.
template <class Bits>
[[gnu::always_inline]] VPM_HD inline Bits edges_that_miss(const SignBits<Bits>& signs) {
  const Bits &above = signs.above, &below = signs.below;
  const Bits of_a = edges_within<Bits>(above & 7) | edges_within<Bits>(below & 7) |
                    (edges_of_a(above, true) & edges_of_a(below, true)),
             of_b = edges_within<Bits>(above >> kHeightsOfB & 7) |
                    edges_within<Bits>(below >> kHeightsOfB & 7) |
                    (edges_of_b(above, true) & edges_of_b(below, true));
  return of_a & of_b;
}
// Value of edges_that_miss() of a pair that is apart.
inline constexpr unsigned kAllEdges = 7;

// Finds how one pair meets, from what doubles tell and exact signs where these leave one open.
class Crossing {
 public:
  VPM_HD Crossing(const PlacedTriangle& a, const PlacedTriangle& b, const PairSigns& signs)
      : a_(a), b_(b), signs_(signs) {}

  VPM_HD Meeting find(TriangleCrossing& found) {
    for (unsigned k = 0; k < 3; ++k) {
      if (is_open(k)) decide(k, b_.corner[0], b_.corner[1], b_.corner[2], a_.corner[k]);
      if (is_open(kHeightsOfB + k))
        decide(kHeightsOfB + k, a_.corner[0], a_.corner[1], a_.corner[2], b_.corner[k]);
    }
    const unsigned rising_a = edges_that_rise(0), rising_b = edges_that_rise(kHeightsOfB);
    if (rising_a == 0 || rising_b == 0) return meeting(Meeting::apart);
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = 0; j < 3; ++j)
        if (is_open(kEdges + 3 * i + j) && ((rising_a >> i & 1) | (rising_b >> j & 1)) != 0)
          decide(kEdges + 3 * i + j, a_.corner[i], a_.corner[(i + 1) % 3], b_.corner[j],
                 b_.corner[(j + 1) % 3]);
    const unsigned above = signs_.above, below = signs_.below;
    const unsigned of_a = rising_a & (edges_of_a(above, false) | edges_of_a(below, false)),
                   of_b = rising_b & (edges_of_b(above, false) | edges_of_b(below, false));
    if ((of_a | of_b) == 0) return meeting(Meeting::apart);
    add_crossings(a_, signs_.above_b, of_a, 0, found);
    add_crossings(b_, signs_.above_a, of_b, kHeightsOfB, found);
    return meeting(starts_ == 1 && ends_ == 1 ? Meeting::crossing : Meeting::undecided);
  }

 private:
  VPM_HD Meeting meeting(Meeting found) const { return has_zero_ ? Meeting::undecided : found; }

  VPM_HD bool is_open(unsigned bit) const {
    return ((signs_.above | signs_.below) >> bit & 1) == 0;
  }
  // Sets a sign that doubles leave open to the exact one.
  VPM_HD void decide(unsigned bit, Vec3 p, Vec3 q, Vec3 r, Vec3 s) {
    const int exact = -orientation(p, q, r, s);
    (exact > 0 ? signs_.above : signs_.below) |= 1u << bit;
    has_zero_ = has_zero_ || exact == 0;
  }

  // Returns the edges with ends on different sides.
  VPM_HD unsigned edges_that_rise(unsigned heights) const {
    return ~(edges_within(signs_.above >> heights & 7) |
             edges_within(signs_.below >> heights & 7)) &
           7;
  }

  VPM_HD void add_crossings(const PlacedTriangle& t, const std::array<double, 3>& above,
                            unsigned edges, unsigned heights, TriangleCrossing& found) {
    const bool is_first = heights == 0;
    int& count = is_first ? found.first_count : found.second_count;
    auto& list = is_first ? found.of_first : found.of_second;
    count = 0;
    for (; edges != 0; edges &= edges - 1) {
      const unsigned k = (edges & 1) != 0 ? 0U : (edges & 2) != 0 ? 1U : 2U, next = (k + 1) % 3;
      const bool enters = (signs_.below >> (heights + next) & 1) != 0;
      const Vec3 place = place_on_edge(t, k, next, above);
      // An edge of the first that enters the other ends the segment; one of the second starts it.
      const bool starts = enters != is_first;
      (starts ? found.start : found.end) = place;
      ++(starts ? starts_ : ends_);
      if (count < 2)
        list[static_cast<std::size_t>(count++)] = {static_cast<int>(k), enters ? 1 : -1, place};
    }
  }

  // Computes from the lower vertex to the higher, so that all triangles of an edge get the same
  // bits.
  VPM_HD static Vec3 place_on_edge(const PlacedTriangle& t, std::size_t k, std::size_t next,
                                   const std::array<double, 3>& above) {
    if (t.index[k] > t.index[next]) std::swap(k, next);
    const double span = above[k] - above[next];
    const double fraction = span != 0 ? std::clamp(quotient(above[k], span), 0.0, 1.0) : 0.5;
    return t.corner[k] + fraction * (t.corner[next] - t.corner[k]);
  }

  const PlacedTriangle &a_, &b_;
  PairSigns signs_;
  int starts_ = 0, ends_ = 0;
  bool has_zero_ = false;
};

// Returns how two triangles meet, and fills `crossing` where they cross. `signs` are what
// signs_of() told of the two, or nothing.
VPM_HD inline Meeting cross_triangles(const PlacedTriangle& a, const PlacedTriangle& b,
                                      const PairSigns& signs, TriangleCrossing& crossing) {
  return Crossing(a, b, signs).find(crossing);
}

}  // namespace vpm
