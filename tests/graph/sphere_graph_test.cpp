#include "libvpm/graph/sphere_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "libvpm/core/error.h"
#include "tests/graph/test_packing.h"

namespace vpm {
namespace {

std::vector<Sphere> scattered_spheres(std::size_t count, std::uint64_t seed) {
  test::Numbers numbers(seed);
  std::vector<Sphere> spheres;
  while (spheres.size() < count) {
    const Sphere s{{numbers.uniform(-1, 1), numbers.uniform(-1, 1), numbers.uniform(-1, 1)},
                   numbers.uniform(0.001, 0.06)};
    if (std::all_of(spheres.begin(), spheres.end(),
                    [&](const Sphere& other) { return surface_gap(s, other) > 0; })) {
      spheres.push_back(s);
    }
  }
  return spheres;
}

std::set<SpherePair> pairs_of(const SphereGraph& graph) {
  std::set<SpherePair> pairs;
  for (std::uint32_t i = 0; i + 1 < graph.begin.size(); ++i) {
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k) {
      pairs.insert({i, graph.neighbors[k]});
    }
  }
  return pairs;
}

// Finds the bridges by Prim's algorithm over all pairs, where edges shorter than epsilon cost
// nothing.
std::set<SpherePair> bridges_by_force(const std::vector<Sphere>& spheres, double epsilon) {
  struct Link {
    double gap;
    std::uint32_t low, high;
    auto operator<=>(const Link&) const = default;
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::uint32_t count = static_cast<std::uint32_t>(spheres.size());
  std::vector<Link> nearest(count, {kInfinity, 0, 0});
  std::vector<bool> in(count);
  std::set<SpherePair> bridges;
  std::uint32_t next = 0;
  for (;;) {
    in[next] = true;
    for (std::uint32_t j = 0; j < count; ++j) {
      const double gap = surface_gap(spheres[next], spheres[j]);
      const Link link{gap < epsilon ? -1 : gap, std::min(next, j), std::max(next, j)};
      nearest[j] = std::min(nearest[j], link);
    }
    const std::uint32_t none = count;
    next = none;
    for (std::uint32_t j = 0; j < count; ++j) {
      if (!in[j] && (next == none || nearest[j] < nearest[next])) next = j;
    }
    if (next == none) return bridges;
    if (nearest[next].gap >= 0) bridges.insert({nearest[next].low, nearest[next].high});
  }
}

TEST(SphereGraph, EdgesAreThePairsWithAGapBelowEpsilon) {
  const std::vector<Sphere> spheres = scattered_spheres(400, 1);
  const SphereBvh bvh(spheres);
  for (const double epsilon : {0.0, 0.005, 0.05, 3.0}) {
    const SphereGraph graph = epsilon_edges(bvh, epsilon);
    std::set<SpherePair> expected;
    for (std::uint32_t i = 0; i < spheres.size(); ++i) {
      for (std::uint32_t j = 0; j < spheres.size(); ++j) {
        if (i != j && surface_gap(spheres[i], spheres[j]) < epsilon) expected.insert({i, j});
      }
    }
    EXPECT_EQ(pairs_of(graph), expected);
    EXPECT_EQ(graph.neighbors.size(), expected.size());
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      EXPECT_TRUE(std::is_sorted(graph.neighbors.begin() + graph.begin[i],
                                 graph.neighbors.begin() + graph.begin[i + 1]));
    }
  }
}

TEST(SphereGraph, BridgesAreTheShortestThatConnect) {
  for (const std::uint64_t seed : {2, 3, 4}) {
    const std::vector<Sphere> spheres = scattered_spheres(300, seed);
    const SphereBvh bvh(spheres);
    for (const double epsilon : {0.0, 0.02, 0.05}) {
      const SphereGraph edges = epsilon_edges(bvh, epsilon);
      std::vector<std::uint32_t> component;
      const std::uint32_t before = connected_components(edges, component);
      const std::vector<SpherePair> bridges = shortest_bridges(bvh, edges);
      EXPECT_EQ(bridges.size(), before - 1);
      EXPECT_EQ(std::set<SpherePair>(bridges.begin(), bridges.end()),
                bridges_by_force(spheres, epsilon));
      EXPECT_EQ(connected_components(with_edges(edges, bridges), component), 1u);
    }
  }
}

TEST(SphereGraph, EqualGapsAreTakenByIndex) {
  // All gaps of a lattice are equal; the spanning tree must be the same each time.
  std::vector<Sphere> spheres;
  for (int k = 0; k < 125; ++k) {
    spheres.push_back({{0.25 * (k % 5), 0.25 * (k / 5 % 5), 0.25 * (k / 25)}, 0.0625});
  }
  const SphereBvh bvh(spheres);
  const std::vector<SpherePair> bridges = shortest_bridges(bvh, epsilon_edges(bvh, 0.01));
  EXPECT_EQ(std::set<SpherePair>(bridges.begin(), bridges.end()), bridges_by_force(spheres, 0.01));
}

TEST(SphereGraph, OneSphereIsConnected) {
  const std::vector<Sphere> one{{{0, 0, 0}, 0.5}};
  const SphereBvh bvh(one);
  const SphereGraph graph = epsilon_edges(bvh, 0.05);
  EXPECT_EQ(graph.begin, (std::vector<std::uint32_t>{0, 0}));
  EXPECT_TRUE(shortest_bridges(bvh, graph).empty());
}

TEST(SphereBvh, FindsTheNearestSurfaceFromAnyStart) {
  const std::vector<Sphere> spheres = scattered_spheres(500, 5);
  const SphereBvh bvh(spheres);
  test::Numbers numbers(6);
  for (int k = 0; k < 500; ++k) {
    const Vec3 x{numbers.uniform(-1.2, 1.2), numbers.uniform(-1.2, 1.2),
                 numbers.uniform(-1.2, 1.2)};
    std::uint32_t expected = 0;
    for (std::uint32_t i = 1; i < spheres.size(); ++i) {
      if (surface_distance(x, spheres[i]) < surface_distance(x, spheres[expected])) expected = i;
    }
    EXPECT_EQ(bvh.nearest_surface(x, 0), expected);
    EXPECT_EQ(bvh.nearest_surface(x, 499), expected);
  }
}

}  // namespace
}  // namespace vpm
