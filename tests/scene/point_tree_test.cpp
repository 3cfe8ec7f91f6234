#include "libvpm/scene/points/point_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>

namespace vpm {
namespace {

std::vector<Vec3f> in_leaf_order(const std::vector<Vec3f>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  order_by_leaves(points, order);
  std::vector<Vec3f> ordered;
  ordered.reserve(order.size());
  for (const std::uint32_t i : order) ordered.push_back(points[i]);
  return ordered;
}

// Points in the tree's order, with the boxes of its nodes.
struct OrderedPoints {
  std::vector<Vec3f> points;
  std::vector<BoxQuad> boxes;

  explicit OrderedPoints(const std::vector<Vec3f>& given)
      : points(in_leaf_order(given)), boxes(boxes_of(points)) {}
  PointTree tree() const {
    return {points.data(), boxes.data(), static_cast<std::uint32_t>(points.size()),
            leaves_for(points.size())};
  }
};

float quarter(double x) {
  return static_cast<float>(std::round(4 * x) / 4);
}
// Returns points anywhere, or on a coarse lattice, where many distances are equal.
std::vector<Vec3f> scattered(std::size_t count, bool on_lattice) {
  std::mt19937 random(static_cast<unsigned>(count));
  std::uniform_real_distribution<float> at(-1, 1);
  std::vector<Vec3f> points;
  while (points.size() < count) {
    const Vec3f p{at(random), at(random), 0.1f * at(random)};
    points.push_back(on_lattice ? Vec3f{quarter(p.x), quarter(p.y), quarter(p.z)} : p);
  }
  return points;
}

std::uint32_t nearest_of_all(const std::vector<Vec3f>& points, Vec3 x, double bound) {
  std::uint32_t best = kNoPoint;
  double least = bound * bound;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const double squared = squared_norm(widen(points[i]) - x);
    if (!(squared < least)) continue;
    least = squared;
    best = i;
  }
  return best;
}

class TreeOf : public ::testing::TestWithParam<std::size_t> {};

TEST_P(TreeOf, FindsTheNearest) {
  for (const bool on_lattice : {false, true}) {
    const OrderedPoints ordered(scattered(GetParam(), on_lattice));
    const PointTree tree = ordered.tree();
    std::mt19937 random(1);
    std::uniform_real_distribution<double> at(-1.5, 1.5);
    for (int k = 0; k < 300; ++k) {
      Vec3 x{at(random), at(random), at(random)};
      if (on_lattice) x = {quarter(x.x), quarter(x.y), quarter(x.z)};
      if (k % 7 == 0) x = 1e6 * x;
      for (const double bound : {HUGE_VAL, 0.5, 0.1}) {
        const std::uint32_t found = nearest_of_all(ordered.points, x, bound);
        ASSERT_EQ(tree.nearest(x, bound), found) << bound << ' ' << on_lattice;
        // A hint beyond the bound is no hint.
        const auto near = static_cast<std::uint32_t>(random() % ordered.points.size());
        ASSERT_EQ(tree.nearest(x, bound, near), found);
      }
    }
  }
}

TEST_P(TreeOf, VisitsThePointsOfABallInOrder) {
  const OrderedPoints ordered(scattered(GetParam(), false));
  for (const double radius : {0.05, 0.4, 3.0}) {
    const Vec3 center{0.1, -0.2, 0.05};
    std::vector<std::uint32_t> expected, visited;
    for (std::uint32_t i = 0; i < ordered.points.size(); ++i) {
      if (squared_norm(widen(ordered.points[i]) - center) <= radius * radius) expected.push_back(i);
    }
    EXPECT_TRUE(ordered.tree().for_points_in_ball(center, radius * radius, [&](std::uint32_t i) {
      visited.push_back(i);
      return true;
    }));
    EXPECT_EQ(visited, expected);
    if (expected.empty()) continue;
    EXPECT_FALSE(ordered.tree().for_points_in_ball(center, radius * radius,
                                                   [](std::uint32_t) { return false; }));
  }
}

TEST_P(TreeOf, FindsTheNearestOfTheBallsThatTouch) {
  const OrderedPoints ordered(scattered(GetParam(), false));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> at(-1.5, 1.5);
  std::uniform_real_distribution<float> wide(0, 0.5);
  std::vector<float> radii;
  for (std::size_t i = 0; i < ordered.points.size(); ++i)
    radii.push_back(random() % 5 == 0 ? wide(random) : 0.01f);
  const std::vector<float> largest = largest_in_nodes(radii);
  const PointTree tree = ordered.tree();
  ASSERT_EQ(largest.size(), tree.nodes());
  for (int k = 0; k < 300; ++k) {
    const Vec3 x{at(random), at(random), 0.5 * at(random)};
    const double radius = 0.3 * std::fabs(at(random));
    std::uint32_t expected = kNoPoint;
    double least = HUGE_VAL;
    for (std::uint32_t i = 0; i < ordered.points.size(); ++i) {
      const double squared = squared_norm(widen(ordered.points[i]) - x), reach = radius + radii[i];
      if (!(squared <= reach * reach && squared < least)) continue;
      least = squared;
      expected = i;
    }
    ASSERT_EQ(tree.nearest_touching(x, radius, {radii.data(), largest.data()}), expected);
  }
}

// Expects that one search for four places finds what four searches do.
void expect_the_same_of_four(const PointTree& tree, const Vec3 (&places)[4], std::uint32_t near) {
  std::uint32_t found[4];
  tree.nearest_of_four(places, near, found);
  for (int k = 0; k < 4; ++k) ASSERT_EQ(found[k], tree.nearest(places[k], HUGE_VAL)) << k;
}

// Places near each other, apart, and at one place; equal distances go to the smaller index.
TEST_P(TreeOf, FindsTheNearestOfFourPlacesAtOnce) {
  const OrderedPoints ordered(scattered(GetParam(), true));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(-1.5, 1.5);
  const PointTree whole = ordered.tree();
  PointTree near = whole;
  near.enter_near({0.3, 0.2, 0}, 0.4);
  for (int k = 0; k < 200; ++k) {
    const Vec3 middle{quarter(at(random)), quarter(at(random)), quarter(at(random))};
    Vec3 places[4];
    for (Vec3& x : places)
      x = middle + quarter(k % 3 * at(random)) * Vec3{1, k % 2 * at(random), k % 5 * 0.25};
    const auto hint = static_cast<std::uint32_t>(random() % ordered.points.size());
    for (const std::uint32_t begin : {kNoPoint, hint}) {
      expect_the_same_of_four(whole, places, begin);
      expect_the_same_of_four(near, places, begin);
    }
  }
}

// Searches that begin near a place find the same points, about it and elsewhere.
TEST_P(TreeOf, FindsTheSameFromNearby) {
  const OrderedPoints ordered(scattered(GetParam(), true));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> at(-1, 1);
  std::vector<float> radii;
  for (std::size_t i = 0; i < ordered.points.size(); ++i)
    radii.push_back(static_cast<float>(0.02 * (at(random) + 1)));
  const std::vector<float> largest = largest_in_nodes(radii);
  const PointNumbers balls{radii.data(), largest.data()};
  const PointTree whole = ordered.tree();
  const auto listed = [](const PointTree& tree, Vec3 center, double radius) {
    std::vector<std::uint32_t> visited;
    tree.for_points_in_ball(center, radius * radius, [&](std::uint32_t i) {
      visited.push_back(i);
      return true;
    });
    return visited;
  };
  bool any_is_small = false;
  for (int k = 0; k < 200; ++k) {
    const Vec3 center = k % 9 == 0 ? 1e3 * Vec3{at(random), 1, 0} : Vec3{at(random), at(random), 0};
    const double reach = 0.1 * (at(random) + 1);
    PointTree near = whole;
    near.enter_near(center, reach);
    any_is_small |= near.entry.nodes[0] >= 16;
    for (int j = 0; j < 8; ++j) {
      const Vec3 x =
          center + (j < 6 ? 0.55 : 3.0) * reach * Vec3{at(random), at(random), at(random)};
      const double radius = reach * (at(random) + 1.05);
      ASSERT_EQ(near.nearest(x, HUGE_VAL), whole.nearest(x, HUGE_VAL));
      ASSERT_EQ(near.nearest(x, radius), whole.nearest(x, radius));
      ASSERT_EQ(near.nearest_touching(x, radius, balls), whole.nearest_touching(x, radius, balls));
      ASSERT_EQ(listed(near, x, radius), listed(whole, x, radius));
    }
  }
  if (GetParam() >= 1000) {
    EXPECT_TRUE(any_is_small);
  }
}

// Tests one leaf, full and not, and trees with an even and an odd number of levels.
INSTANTIATE_TEST_SUITE_P(Points, TreeOf,
                         ::testing::Values(1, 2, 7, 8, 9, 16, 17, 31, 33, 64, 65, 100, 129, 1000,
                                           4096, 5000),
                         ::testing::PrintToStringParamName());

TEST(PointTree, OfNoPointsFindsNone) {
  const OrderedPoints none({});
  EXPECT_EQ(none.tree().nearest({}, HUGE_VAL), kNoPoint);
  EXPECT_TRUE(none.tree().for_points_in_ball({}, 1, [](std::uint32_t) { return false; }));
  EXPECT_EQ(PointTree{}.nearest({}, HUGE_VAL), kNoPoint);
}

TEST(PointList, FindsTheNearestAndTheFirstOfSeveral) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> at(-1.5, 1.5);
  for (const int size : {1, 2, 3, 4, 5, 8, 11, 64, PointList::kMost}) {
    const std::vector<Vec3f> points = scattered(static_cast<std::size_t>(size), true);
    PointList list;
    for (std::uint32_t i = 0; i < points.size(); ++i) ASSERT_TRUE(list.add(7 * i, points[i]));
    ASSERT_EQ(list.add(0, {}), size < PointList::kMost);
    list.clear();
    ASSERT_TRUE(list.is_empty());
    for (std::uint32_t i = 0; i < points.size(); ++i) list.add(7 * i, points[i]);
    for (int k = 0; k < 200; ++k) {
      const Vec3 x{quarter(at(random)), quarter(at(random)), quarter(at(random))};
      ASSERT_EQ(list.nearest(x), 7 * nearest_of_all(points, x, HUGE_VAL)) << size;
    }
  }
}

TEST(LeafOrder, KeepsEachPointOnce) {
  std::vector<std::uint32_t> order(1003);
  std::iota(order.begin(), order.end(), 0u);
  order_by_leaves(scattered(order.size(), true), order);
  std::sort(order.begin(), order.end());
  for (std::uint32_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
}

// The eight points of a leaf are neighbours: on a square lattice, two rows of four.
TEST(LeafOrder, MakesCompactLeaves) {
  constexpr int kSide = 64;
  std::vector<Vec3f> lattice;
  lattice.reserve(std::size_t{kSide} * kSide);
  for (int i = 0; i < kSide; ++i) {
    for (int k = 0; k < kSide; ++k)
      lattice.push_back(
          {static_cast<float>(i), static_cast<float>(k), 0.3f * static_cast<float>(i)});
  }
  const OrderedPoints ordered(lattice);
  const PointTree tree = ordered.tree();
  for (std::uint32_t i = 0; i < tree.count; i += PointTree::kLeafSize) {
    const PointBox box = tree.leaf_of(i);
    EXPECT_LE(std::max(box.high.x - box.low.x, box.high.y - box.low.y), 3);
    EXPECT_LE(std::min(box.high.x - box.low.x, box.high.y - box.low.y), 1);
  }
}

}  // namespace
}  // namespace vpm
