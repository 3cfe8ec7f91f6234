// Which of many solids share volume, against what is known of boxes.

#include <gtest/gtest.h>
#include <vpm/device.h>
#include <vpm/solid.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "tests/api/boxes.h"

namespace {

using vpm::OverlappingPair;
using vpm::Part;
using vpm::SolidBody;
using vpm::test::box;
using vpm::test::kind_of;

constexpr double kEdge = 0.05;  // m; 1.25e-4 m^3

SolidBody edge_cube() {
  return SolidBody(box({}, {kEdge, kEdge, kEdge}), false);
}

// Returns n x n x n cubes, one every `pitch`.
std::vector<Part> grid(int n, double pitch) {
  const SolidBody solid = edge_cube();
  std::vector<Part> parts;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) parts.push_back({solid, {{}, {pitch * x, pitch * y, pitch * z}}});
  return parts;
}

double shared_length(double a, double b) {
  return std::max(0.0, kEdge - std::abs(a - b));
}

// Returns the volume that two unturned cubes share.
double truth(const Part& a, const Part& b) {
  const vpm::Vec3 p = a.to_world.translation, q = b.to_world.translation;
  return shared_length(p.x, q.x) * shared_length(p.y, q.y) * shared_length(p.z, q.z);
}

// Expects each pair of cubes that share more than `least`, and no other, with its volume.
void expect_truth(const std::vector<Part>& parts, const std::vector<OverlappingPair>& found,
                  double least) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j = i + 1; j < parts.size(); ++j) {
      const double volume = truth(parts[i], parts[j]);
      if (volume < least) continue;
      ASSERT_LT(next, found.size()) << i << " and " << j << " are missed";
      EXPECT_EQ(found[next].first, i);
      EXPECT_EQ(found[next].second, j);
      EXPECT_NEAR(found[next].overlap.volume, volume, 1e-9 * kEdge * kEdge * kEdge);
      EXPECT_EQ(found[next].refusal, "");
      ++next;
    }
  EXPECT_EQ(next, found.size());
}

TEST(Assembly, OfCubesInAGridSharesWhatIsKnown) {
  // Neighbours share slabs, rods and, by their corners, 1e-9 m^3.
  const std::vector<Part> parts = grid(5, kEdge - 1e-3);
  const auto found = vpm::overlapping_pairs(parts);
  expect_truth(parts, found, 1e-10);
  EXPECT_EQ(found.size(), 1036U);  // 300 by faces, 480 by edges, 256 by corners
}

TEST(Assembly, OfFlushPartsHasNoPairs) {
  EXPECT_TRUE(vpm::overlapping_pairs(grid(4, kEdge)).empty());
  // Turned as a whole, and far from the origin, where places round.
  const vpm::Rotation turn = vpm::rotation_from_quaternion({.1, .2, .3, std::sqrt(1 - .14)});
  for (const double far : {0.0, 1e3, 1e6}) {
    std::vector<Part> parts = grid(3, kEdge);
    for (Part& part : parts) {
      const auto [x, y, z] = part.to_world.translation;
      const auto along = [&](vpm::Vec3 row) { return row.x * x + row.y * y + row.z * z; };
      part.to_world = {turn, {far + along(turn.row0), along(turn.row1), along(turn.row2) - far}};
    }
    EXPECT_TRUE(vpm::overlapping_pairs(parts).empty()) << far;
  }
}

TEST(Assembly, OfAFlushStackOfThinPlatesHasNoPairs) {
  const SolidBody plate(box({}, {1, 1, 1e-3}), false);
  std::vector<Part> parts;
  for (int k = 0; k < 20; ++k) parts.push_back({plate, {{}, {0, 0, 1e-3 * k}}});
  EXPECT_TRUE(vpm::overlapping_pairs(parts).empty());
}

TEST(Assembly, FindsPartsInsideOthers) {
  const SolidBody small(box({}, {1e-3, 1e-3, 1e-3}), false);
  const std::vector<Part> parts{
      {edge_cube(), {}}, {small, {{}, {.02, .02, .02}}}, {edge_cube(), {}}};
  const auto found = vpm::overlapping_pairs(parts);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NEAR(found[0].overlap.volume, 1e-9, 1e-15);
  EXPECT_NEAR(found[0].overlap.centroid.x, .0205, 1e-9);
  EXPECT_NEAR(found[1].overlap.volume, kEdge * kEdge * kEdge, 1e-12);  // twins at one place
  EXPECT_NEAR(found[2].overlap.volume, 1e-9, 1e-15);
}

// Two cubes that share a cube of a micrometre at their corners.
TEST(Assembly, FindsCornersThatMeet) {
  const double apart = kEdge - 1e-6;
  const auto found = vpm::overlapping_pairs(
      std::vector<Part>{{edge_cube(), {}}, {edge_cube(), {{}, {apart, apart, apart}}}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].overlap.volume, 1e-18, 1e-20);
}

// Cubes at random places, some of which share as little as 1e-9 m^3.
std::vector<Part> scattered(std::size_t count) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(0, .3);
  const SolidBody solid = edge_cube();
  std::vector<Part> parts;
  for (std::size_t k = 0; k < count; ++k)
    parts.push_back({solid, {{}, {place(random), place(random), place(random)}}});
  return parts;
}

TEST(Assembly, MissesNoneOfScatteredCubes) {
  const std::vector<Part> parts = scattered(120);
  expect_truth(parts, vpm::overlapping_pairs(parts), 1e-12);
}

TEST(Assembly, OrderOfPartsChangesNoBit) {
  const std::vector<Part> parts = scattered(60);
  const auto found = vpm::overlapping_pairs(parts);
  std::vector<std::size_t> order(parts.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::shuffle(order.begin(), order.end(), std::mt19937_64(4));
  std::vector<Part> shuffled;
  for (const std::size_t k : order) shuffled.push_back(parts[k]);
  const auto again = vpm::overlapping_pairs(shuffled);
  ASSERT_EQ(again.size(), found.size());
  for (const OverlappingPair& pair : again) {
    const auto [first, second] = std::minmax(order[pair.first], order[pair.second]);
    const auto same = std::ranges::find_if(
        found, [&](const OverlappingPair& f) { return f.first == first && f.second == second; });
    ASSERT_NE(same, found.end());
    EXPECT_EQ(same->overlap.volume, pair.overlap.volume);
    EXPECT_EQ(same->overlap.centroid, pair.overlap.centroid);
    EXPECT_EQ(same->overlap.closure, pair.overlap.closure);
  }
}

bool are_same(const std::vector<OverlappingPair>& a, const std::vector<OverlappingPair>& b) {
  return std::ranges::equal(a, b, [](const OverlappingPair& x, const OverlappingPair& y) {
    return x.first == y.first && x.second == y.second && x.overlap == y.overlap;
  });
}

TEST(Assembly, NumberOfThreadsChangesNoBit) {
  const std::vector<Part> parts = scattered(80);
  vpm::set_thread_count(1);
  const auto one = vpm::overlapping_pairs(parts);
  vpm::set_thread_count(4);
  const auto four = vpm::overlapping_pairs(parts);
  vpm::set_thread_count(0);
  EXPECT_FALSE(one.empty());
  EXPECT_TRUE(are_same(one, four));
}

TEST(Assembly, IsAskedByManyThreadsAtOnce) {
  const std::vector<Part> parts = scattered(40);
  const auto alone = vpm::overlapping_pairs(parts);
  std::vector<std::vector<OverlappingPair>> found(4);
  std::vector<std::thread> threads;
  for (auto& pairs : found) threads.emplace_back([&] { pairs = vpm::overlapping_pairs(parts); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& pairs : found) EXPECT_TRUE(are_same(pairs, alone));
}

TEST(Assembly, HasTheAnswersOfItsPairs) {
  const SolidBody a(box({}, {.1, .1, .1})), b(box({}, {.1, .2, .3}));
  const std::vector<Part> parts{{b, {{}, {.03, .02, .04}}}, {a, {}}};
  const vpm::OverlapOptions options{.stiffness = 1e5};
  const auto found = vpm::overlapping_pairs(parts, options);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].overlap, vpm::overlap(b, parts[0].to_world, a, parts[1].to_world, options));
  EXPECT_NE(found[0].overlap.wrench.force, vpm::Vec3{});
}

TEST(Assembly, OfFewPartsHasNoPairs) {
  EXPECT_TRUE(vpm::overlapping_pairs({}).empty());
  EXPECT_TRUE(vpm::overlapping_pairs(grid(1, 1)).empty());
}

TEST(Assembly, RefusesPosesAndOptionsByName) {
  std::vector<Part> parts = grid(2, kEdge);
  const auto ask = [&](const vpm::OverlapOptions& options) {
    vpm::overlapping_pairs(parts, options);
  };
  EXPECT_EQ(kind_of([&] { ask({}); }), vpm::ErrorKind::invalid_argument);  // made without forces
  EXPECT_EQ(kind_of([&] { ask({.with_force = false, .stiffness = -1}); }),
            vpm::ErrorKind::invalid_argument);
  parts[5].to_world.translation.y = std::numeric_limits<double>::quiet_NaN();
  try {
    ask({.with_force = false});
    FAIL() << "a pose that is none is taken";
  } catch (const vpm::Error& error) {
    EXPECT_EQ(error.kind(), vpm::ErrorKind::refused);
    EXPECT_EQ(error.where(), "part 5");
  }
}

}  // namespace
