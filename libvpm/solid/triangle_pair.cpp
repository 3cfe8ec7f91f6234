#include "libvpm/solid/triangle_pair.h"

#include <algorithm>
#include <bit>

#include "libvpm/core/lanes.h"
#include "libvpm/core/vec3x4.h"

namespace vpm {
namespace {

using FourPairs = PairTests<Double4>;

[[gnu::always_inline]] inline FourPairs four_pairs(std::span<const PlacedTriangle> as,
                                                   std::span<const PlacedTriangle> bs,
                                                   std::span<const CandidatePair> pairs,
                                                   std::size_t first) {
  const auto [p, q, r, s] = four_of(pairs, first);
  const PlacedTriangle &a0 = as[p.a], &a1 = as[q.a], &a2 = as[r.a], &a3 = as[s.a];
  const PlacedTriangle &b0 = bs[p.b], &b1 = bs[q.b], &b2 = bs[r.b], &b3 = bs[s.b];
  std::array<Vec3x4, 3> of_a, of_b;
  for (std::size_t k = 0; k < 3; ++k) {
    of_a[k] = {a0.corner[k], a1.corner[k], a2.corner[k], a3.corner[k]};
    of_b[k] = {b0.corner[k], b1.corner[k], b2.corner[k], b3.corner[k]};
  }
  return {of_a,
          {a0.normal, a1.normal, a2.normal, a3.normal},
          of_b,
          {b0.normal, b1.normal, b2.normal, b3.normal},
          Double4{a0.longest_edge, a1.longest_edge, a2.longest_edge, a3.longest_edge} +
              Double4{b0.longest_edge, b1.longest_edge, b2.longest_edge, b3.longest_edge}};
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

// Returns a bit for each pair whose signs tell that it is apart.
[[gnu::always_inline]] inline unsigned told_apart(const SignBits<Bits4>& signs) {
  return mask_of(converted<Int4>(edges_that_miss(signs) == kAllEdges));
}

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
    const SignBits<Bits4> found = signs_of<Bits4>(four);
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

}  // namespace vpm
