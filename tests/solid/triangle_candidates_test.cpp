// Pairs of triangles that never reach the exact signs: what trees and floats rule out is apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "libvpm/core/box.h"
#include "libvpm/solid/tree_walk.h"
#include "libvpm/solid/triangle_filter.h"
#include "libvpm/solid/triangle_pair.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using Corners = std::array<Vec3, 3>;

PlacedTriangle placed(const Corners& corners) {
  const auto& [a, b, c] = corners;
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  return {corners, {0, 1, 2}, cross(b - a, c - a), 1.00001 * longest};
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
      TriangleCrossing crossing;
      if (!apart(p, q) && cross_triangles(placed(p), placed(q), crossing) == Meeting::crossing)
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

// Returns whether the filter tells that these are apart, in a unit that holds both.
bool are_apart_in_floats(const PlacedTriangle& p, const PlacedTriangle& q, double scale) {
  const auto filter = [&](const PlacedTriangle& t) {
    return filter_triangle(t.corner, t.normal, t.longest_edge, scale);
  };
  return are_apart(filter(p), filter(q));
}

TEST(TriangleCandidates, FloatsRuleOutNoPairThatMeets) {
  for (const double size : {.3, .01, 1e-4, 1e-6}) {
    Triangles triangles(size);
    int meeting = 0, told = 0, right = 0;
    for (int k = 0; k < 20000; ++k) {
      const PlacedTriangle p = placed(triangles.any()), q = placed(triangles.touching(p.corner));
      TriangleCrossing crossing;
      const bool is_apart = cross_triangles(p, q, crossing) == Meeting::apart;
      const bool is_told = are_apart_in_floats(p, q, .25);
      EXPECT_FALSE(is_told && !is_apart);
      meeting += !is_apart, told += is_told;
      const PlacedTriangle r = placed(triangles.any());
      right +=
          are_apart_in_floats(p, r, .25) != (cross_triangles(p, r, crossing) != Meeting::apart);
    }
    EXPECT_GT(meeting, 1000);
    EXPECT_GT(told, 0);
    EXPECT_GT(right, 19900) << "floats tell next to all that are not made to touch, of size "
                            << size;
  }
}

// So that scaling by powers of two, and no other unit, changes nothing.
TEST(TriangleCandidates, WhatFloatsTellIsOfNoUnit) {
  Triangles triangles(.1);
  for (int k = 0; k < 1000; ++k) {
    const Corners s = triangles.any(), t = triangles.touching(s);
    Corners far_s = s, far_t = t;
    for (Corners* corners : {&far_s, &far_t})
      for (Vec3& corner : *corners) corner = 0x1p40 * corner;
    EXPECT_EQ(are_apart_in_floats(placed(s), placed(t), .25),
              are_apart_in_floats(placed(far_s), placed(far_t), 0x1p-42));
  }
}

}  // namespace
}  // namespace vpm
