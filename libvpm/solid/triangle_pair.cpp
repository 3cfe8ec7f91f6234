#include "libvpm/solid/triangle_pair.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "libvpm/core/lanes.h"
#include "libvpm/core/vec3x4.h"
#include "libvpm/mesh/predicates.h"

namespace vpm {
namespace {

// Rounding error of the determinants here, by far, relative to the cube of the largest distance of
// two corners: each is a sum of two dozen products of three differences.
constexpr double kFilter = 3e-14;
// The corners of two triangles with overlapping boxes are within so many times the sum of their
// longest edges: the root of three for boxes, and their padding.
constexpr double kSpread = 1.8;
// First bits, in PairSigns, of the heights of b's corners and of the pairs of edges.
constexpr unsigned kHeightsOfB = 3, kEdges = 6;

// Holds four pairs of triangles side by side, and what their tests share.
struct FourPairs {
  std::array<Vec3x4, 3> a, b;  // corners, about the first of b
  Vec3x4 normal_a, normal_b;
  std::array<Double4, 3> above_b, above_a;  // heights of a's corners over b's plane, and of b's
  Double4 bound;                            // of errors of determinants
};

[[gnu::always_inline]] inline FourPairs four_pairs(std::span<const PlacedTriangle> as,
                                                   std::span<const PlacedTriangle> bs,
                                                   std::span<const CandidatePair> pairs,
                                                   std::size_t first) {
  const auto [p, q, r, s] = four_of(pairs, first);
  const PlacedTriangle &a0 = as[p.a], &a1 = as[q.a], &a2 = as[r.a], &a3 = as[s.a];
  const PlacedTriangle &b0 = bs[p.b], &b1 = bs[q.b], &b2 = bs[r.b], &b3 = bs[s.b];
  FourPairs four;
  const Vec3x4 origin(b0.corner[0], b1.corner[0], b2.corner[0], b3.corner[0]);
  Vec3x4 first_of_a;
  four.normal_a = {a0.normal, a1.normal, a2.normal, a3.normal};
  four.normal_b = {b0.normal, b1.normal, b2.normal, b3.normal};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3x4 of_a(a0.corner[k], a1.corner[k], a2.corner[k], a3.corner[k]),
        of_b(b0.corner[k], b1.corner[k], b2.corner[k], b3.corner[k]);
    if (k == 0) first_of_a = of_a;
    four.a[k] = of_a - origin, four.b[k] = of_b - origin;
    four.above_b[k] = dot(four.normal_b, four.a[k]);
    four.above_a[k] = dot(four.normal_a, of_b - first_of_a);
  }
  const Double4 spread =
      kSpread * (Double4{a0.longest_edge, a1.longest_edge, a2.longest_edge, a3.longest_edge} +
                 Double4{b0.longest_edge, b1.longest_edge, b2.longest_edge, b3.longest_edge});
  four.bound = kFilter * (spread * spread * spread);
  return four;
}

// Returns a bit for each of the four pairs of which one triangle's corners all lie on one side of
// the other's plane.
[[gnu::always_inline]] inline unsigned on_one_side(const FourPairs& four) {
  const auto same = [&](const std::array<Double4, 3>& h) __attribute__((always_inline)) {
    return ((h[0] > four.bound) & (h[1] > four.bound) & (h[2] > four.bound)) |
           ((h[0] < -four.bound) & (h[1] < -four.bound) & (h[2] < -four.bound));
  };
  return mask_of(converted<Int4>(same(four.above_b) | same(four.above_a)));
}

using Bits4 = std::uint64_t __attribute__((vector_size(4 * sizeof(std::uint64_t))));

// Holds the signs of four pairs, in the bits of PairSigns.
struct FourSigns {
  Bits4 above{}, below{};

  [[gnu::always_inline]] void set(unsigned bit, const Double4& value, const Double4& bound) {
    above |= reinterpret_cast<Bits4>(value > bound) & std::uint64_t{1} << bit;
    below |= reinterpret_cast<Bits4>(value < -bound) & std::uint64_t{1} << bit;
  }
};

// Returns the signs that doubles tell.
[[gnu::always_inline]] inline FourSigns signs_of(const FourPairs& four) {
  FourSigns signs;
  const auto& a = four.a;
  const auto& b = four.b;
  for (unsigned k = 0; k < 3; ++k) {
    signs.set(k, four.above_b[k], four.bound);
    signs.set(kHeightsOfB + k, four.above_a[k], four.bound);
  }
  // Plücker coordinates tell on which side edges of a pass those of b. About b's first corner only
  // b's second edge has a moment, and the volumes of one edge of a add up to what it rises.
  for (unsigned i = 0; i < 3; ++i) {
    const unsigned next = (i + 1) % 3, bit = kEdges + 3 * i;
    const Vec3x4 moment = cross(a[i], a[next]);
    const Double4 first = dot(moment, b[1]), third = -dot(moment, b[2]);
    signs.set(bit, first, four.bound);
    signs.set(bit + 1, four.above_b[next] - four.above_b[i] - first - third, four.bound);
    signs.set(bit + 2, third, four.bound);
  }
  return signs;
}

// The following take the signs of one pair or of four, and return bits 0 to 2 for the edges of a
// triangle.

// Returns the edges of which both ends are among three bits.
template <class Bits>
[[gnu::always_inline]] inline Bits edges_within(const Bits& corners) {
  return corners & (corners >> 1 | corners << 2) & 7;
}
// Returns the edges of a of which any, or all, volumes with edges of b are set.
template <class Bits>
[[gnu::always_inline]] inline Bits edges_of_a(const Bits& signs, bool any) {
  const Bits e = signs >> kEdges;
  const Bits rows = (any ? e | e >> 1 | e >> 2 : e & e >> 1 & e >> 2) & 0x49;  // bits 0, 3 and 6
  return (rows | rows >> 2 | rows >> 4) & 7;
}
// Returns the same of b with edges of a.
template <class Bits>
[[gnu::always_inline]] inline Bits edges_of_b(const Bits& signs, bool any) {
  const Bits e = signs >> kEdges;
  return (any ? e | e >> 3 | e >> 6 : e & e >> 3 & e >> 6) & 7;
}

// Returns a bit for each pair whose signs tell that each edge misses the other triangle: both its
// ends lie on one side, or it passes on different sides of two edges.
[[gnu::always_inline]] inline unsigned told_apart(const FourSigns& signs) {
  const Bits4 &above = signs.above, &below = signs.below;
  const auto on_one_side = [&](unsigned heights) __attribute__((always_inline)) {
    return edges_within<Bits4>(above >> heights & 7) | edges_within<Bits4>(below >> heights & 7);
  };
  const Bits4 of_a = on_one_side(0) | (edges_of_a(above, true) & edges_of_a(below, true)),
              of_b = on_one_side(kHeightsOfB) | (edges_of_b(above, true) & edges_of_b(below, true));
  return mask_of(converted<Int4>((of_a & of_b) == 7));
}

// Finds how one pair meets, from what doubles tell and exact signs where these leave one open.
class Crossing {
 public:
  Crossing(const PlacedTriangle& a, const PlacedTriangle& b, const PairSigns& signs)
      : a_(a), b_(b), signs_(signs) {}

  Meeting find(TriangleCrossing& found) {
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
  Meeting meeting(Meeting found) const { return has_zero_ ? Meeting::undecided : found; }

  bool is_open(unsigned bit) const { return ((signs_.above | signs_.below) >> bit & 1) == 0; }
  // Sets a sign that doubles leave open to the exact one.
  void decide(unsigned bit, Vec3 p, Vec3 q, Vec3 r, Vec3 s) {
    const int exact = -orientation(p, q, r, s);
    (exact > 0 ? signs_.above : signs_.below) |= 1u << bit;
    has_zero_ = has_zero_ || exact == 0;
  }

  // Returns the edges with ends on different sides.
  unsigned edges_that_rise(unsigned heights) const {
    return ~(edges_within(signs_.above >> heights & 7) |
             edges_within(signs_.below >> heights & 7)) &
           7;
  }

  void add_crossings(const PlacedTriangle& t, const std::array<double, 3>& above, unsigned edges,
                     unsigned heights, TriangleCrossing& found) {
    const bool is_first = heights == 0;
    int& count = is_first ? found.first_count : found.second_count;
    auto& list = is_first ? found.of_first : found.of_second;
    count = 0;
    for (; edges != 0; edges &= edges - 1) {
      const auto k = static_cast<unsigned>(std::countr_zero(edges)), next = (k + 1) % 3;
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
  static Vec3 place_on_edge(const PlacedTriangle& t, std::size_t k, std::size_t next,
                            const std::array<double, 3>& above) {
    if (t.index[k] > t.index[next]) std::swap(k, next);
    const double span = above[k] - above[next];
    const double fraction = span != 0 ? std::clamp(above[k] / span, 0.0, 1.0) : 0.5;
    return t.corner[k] + fraction * (t.corner[next] - t.corner[k]);
  }

  const PlacedTriangle &a_, &b_;
  PairSigns signs_;
  int starts_ = 0, ends_ = 0;
  bool has_zero_ = false;
};

// Drops the pairs that heights over planes tell to be apart: half of all or more, for a third of
// the time that the volumes of edges take.
VPM_VECTOR_CLONES
void drop_on_one_side(std::span<const PlacedTriangle> a, std::span<const PlacedTriangle> b,
                      std::vector<CandidatePair>& pairs) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < pairs.size(); k += 4) {
    const unsigned dropped = on_one_side(four_pairs(a, b, pairs, k));
    for (std::size_t lane = 0; lane < 4 && k + lane < pairs.size(); ++lane) {
      pairs[kept] = pairs[k + lane];
      kept += 1 - (dropped >> lane & 1);
    }
  }
  pairs.resize(kept);
}

}  // namespace

VPM_VECTOR_CLONES
void drop_apart(std::span<const PlacedTriangle> a, std::span<const PlacedTriangle> b,
                std::vector<CandidatePair>& pairs, std::vector<PairSigns>& signs) {
  drop_on_one_side(a, b, pairs);
  signs.resize(pairs.size());
  std::size_t kept = 0;
  for (std::size_t k = 0; k < pairs.size(); k += 4) {
    const FourPairs four = four_pairs(a, b, pairs, k);
    const FourSigns found = signs_of(four);
    const std::size_t count = std::min<std::size_t>(pairs.size() - k, 4);
    for (unsigned rest = ~told_apart(found) & ((1u << count) - 1); rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      const auto of = [&](const std::array<Double4, 3>& heights) {
        return std::array{heights[0][lane], heights[1][lane], heights[2][lane]};
      };
      pairs[kept] = pairs[k + static_cast<std::size_t>(lane)];
      signs[kept++] = {of(four.above_b), of(four.above_a), static_cast<unsigned>(found.above[lane]),
                       static_cast<unsigned>(found.below[lane])};
    }
  }
  pairs.resize(kept);
}

Meeting cross_triangles(const PlacedTriangle& a, const PlacedTriangle& b, const PairSigns& signs,
                        TriangleCrossing& crossing) {
  return Crossing(a, b, signs).find(crossing);
}

}  // namespace vpm
