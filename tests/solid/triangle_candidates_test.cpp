// Pairs of triangles that never reach the exact signs: what trees and doubles rule out is apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "libvpm/core/box.h"
#include "libvpm/solid/tree_walk.h"
#include "libvpm/solid/triangle_pair.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using Corners = std::array<Vec3, 3>;

PlacedTriangle placed(const Corners& corners) {
  const auto& [a, b, c] = corners;
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  return {corners, cross(b - a, c - a), 1.00001 * longest, {0, 1, 2}};
}

// Finds how two triangles meet by exact signs alone.
Meeting exact_meeting(const PlacedTriangle& p, const PlacedTriangle& q) {
  TriangleCrossing crossing;
  return cross_triangles(p, q, {}, crossing);
}

Corners corners_of(const SurfaceTree& tree, std::uint32_t triangle, const Pose& pose) {
  Corners corners = tree.corners(triangle);
  for (Vec3& corner : corners) corner = pose * corner;
  return corners;
}

// Returns the pairs that cross, by trying all.
std::set<std::pair<std::uint32_t, std::uint32_t>> crossings(const SurfaceTree& a,
                                                            const SurfaceTree& b,
                                                            const Pose& pose) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> found;
  const auto apart = [](const Corners& p, const Corners& q) {
    Box of_p, of_q;
    for (const Vec3& v : p) of_p.add(v);
    for (const Vec3& v : q) of_q.add(v);
    return of_p.low.x > of_q.high.x || of_q.low.x > of_p.high.x || of_p.low.y > of_q.high.y ||
           of_q.low.y > of_p.high.y || of_p.low.z > of_q.high.z || of_q.low.z > of_p.high.z;
  };
  for (std::uint32_t s = 0; s < a.triangles().size(); ++s)
    for (std::uint32_t t = 0; t < b.triangles().size(); ++t) {
      const Corners p = a.corners(s), q = corners_of(b, t, pose);
      if (!apart(p, q) && exact_meeting(placed(p), placed(q)) == Meeting::crossing)
        found.insert({s, t});
    }
  return found;
}

// Also of solids of very different sizes and of few and many triangles.
TEST(TriangleCandidates, TreesMissNoPairThatCrosses) {
  using namespace synthetic;
  const std::vector<Solid> solids{make_box(.5, .4, .3), make_torus(.3, .1, 24, 12),
                                  make_icosphere(.02, 2), make_box(3, 4, .01)};
  std::vector<std::shared_ptr<const SolidSurface>> all;
  for (const Solid& solid : solids) all.push_back(test::surface(solid));
  std::mt19937_64 random(5);
  std::size_t crossed = 0;
  for (const auto& first : all)
    for (const auto& second : all)
      for (int k = 0; k < 3; ++k) {
        const Pose pose = test::random_pose(random, .3);
        TreeWalk walk;
        std::set<std::pair<std::uint32_t, std::uint32_t>> candidates;
        const auto found = walk.run(first->tree(), second->tree(), pose);
        for (const auto& [s, t] : found) candidates.insert({s, t});
        EXPECT_EQ(candidates.size(), found.size()) << "a pair is listed twice";
        for (const auto& pair : crossings(first->tree(), second->tree(), pose)) {
          EXPECT_TRUE(candidates.contains(pair));
          ++crossed;
        }
      }
  EXPECT_GT(crossed, 1000u);
}

// Random triangles within a cube, and one that is moved so that a corner or an edge all but touches
// the other, from far beyond the error of floats to far below.
class Triangles {
 public:
  explicit Triangles(double size) : size_(size) {}

  Corners any() {
    const Vec3 middle = 0.5 * vector();
    return {middle + size_ * vector(), middle + size_ * vector(), middle + size_ * vector()};
  }
  Corners touching(const Corners& other) {
    Corners t = any();
    const auto on = [&](const Corners& c, bool on_edge) {
      const double p = share_(random_), q = on_edge ? 0 : (1 - p) * share_(random_);
      return c[0] + p * (c[1] - c[0]) + q * (c[2] - c[0]);
    };
    const bool on_edges = share_(random_) < .5;
    const Vec3 gap = size_ * std::pow(10, -12 * share_(random_)) * vector();
    const Vec3 by = on(other, on_edges) - (on_edges ? on(t, true) : t[0]) + gap;
    for (Vec3& corner : t) corner = corner + by;
    return t;
  }

 private:
  Vec3 vector() { return {in_cube_(random_), in_cube_(random_), in_cube_(random_)}; }
  std::mt19937_64 random_{7};
  std::uniform_real_distribution<double> in_cube_{-1, 1}, share_{0, 1};
  double size_;
};

// Returns what doubles tell of the pairs p[k], q[k]; nothing of those that they tell to be apart.
std::vector<std::optional<PairSigns>> told(const std::vector<PlacedTriangle>& p,
                                           const std::vector<PlacedTriangle>& q) {
  std::vector<CandidatePair> pairs;
  for (std::uint32_t k = 0; k < p.size(); ++k) pairs.push_back({k, k});
  std::vector<PairSigns> signs;
  drop_apart(p, q, pairs, signs);
  std::vector<std::optional<PairSigns>> all(p.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) all[pairs[k].a] = signs[k];
  return all;
}

TEST(TriangleCandidates, DoublesTellWhatExactSignsTell) {
  for (const double size : {.3, .01, 1e-4, 1e-6}) {
    Triangles triangles(size);
    std::vector<PlacedTriangle> first, touching, other;
    for (int k = 0; k < 20001; ++k) {  // no multiple of four
      first.push_back(placed(triangles.any()));
      touching.push_back(placed(triangles.touching(first.back().corner)));
      other.push_back(placed(triangles.any()));
    }
    const auto told_of_touching = told(first, touching), told_of_others = told(first, other);
    int meeting = 0, apart = 0, right = 0;
    for (std::size_t k = 0; k < first.size(); ++k) {
      const Meeting truth = exact_meeting(first[k], touching[k]);
      const auto& signs = told_of_touching[k];
      TriangleCrossing crossing;
      EXPECT_EQ(signs ? cross_triangles(first[k], touching[k], *signs, crossing) : Meeting::apart,
                truth);
      meeting += truth != Meeting::apart, apart += !signs;
      right += !told_of_others[k] == (exact_meeting(first[k], other[k]) == Meeting::apart);
    }
    EXPECT_GT(meeting, 1000);
    EXPECT_GT(apart, 1000);
    EXPECT_GT(right, 19900) << "doubles tell next to all that are not made to touch, of size "
                            << size;
  }
}

// So that scaling by powers of two, and no other unit, changes nothing.
TEST(TriangleCandidates, WhatDoublesTellIsOfNoUnit) {
  for (const double scale : {0x1p40, 0x1p-60}) {
    Triangles triangles(.1);
    std::vector<PlacedTriangle> s, t, far_s, far_t;
    for (int k = 0; k < 1000; ++k) {
      Corners corners = triangles.any(), other = triangles.touching(corners);
      s.push_back(placed(corners)), t.push_back(placed(other));
      for (Corners* of : {&corners, &other})
        for (Vec3& corner : *of) corner = scale * corner;
      far_s.push_back(placed(corners)), far_t.push_back(placed(other));
    }
    const auto near = told(s, t), far = told(far_s, far_t);
    for (std::size_t k = 0; k < s.size(); ++k) {
      ASSERT_EQ(near[k].has_value(), far[k].has_value());
      if (!near[k]) continue;
      EXPECT_EQ(near[k]->above, far[k]->above);
      EXPECT_EQ(near[k]->below, far[k]->below);
    }
  }
}

}  // namespace
}  // namespace vpm
