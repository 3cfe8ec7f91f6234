#include "libvpm/graph/hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libvpm/graph/enclosing_sphere.h"
#include "tests/graph/test_packing.h"

namespace vpm {
namespace {

// Expects every sphere once, children after their parent, and every node to enclose the spheres
// below it.
void expect_sound(const Hierarchy& tree, const std::vector<Sphere>& spheres) {
  std::vector<std::uint32_t> leaves = tree.leaves;
  std::sort(leaves.begin(), leaves.end());
  std::vector<std::uint32_t> all(spheres.size());
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(leaves, all);
  std::vector<std::vector<std::uint32_t>> below(tree.nodes.size());
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    const HierarchyNode& node = tree.nodes[n];
    ASSERT_LT(node.begin, node.end);
    ASSERT_LE(node.end - node.begin, kPrototypes);
    for (std::uint32_t child = node.begin; child < node.end; ++child) {
      if (node.children_are_leaves != 0) {
        below[n].push_back(tree.leaves[child]);
      } else {
        ASSERT_GT(child, n);
        below[n].insert(below[n].end(), below[child].begin(), below[child].end());
      }
    }
    for (const std::uint32_t i : below[n]) {
      ASSERT_LE(norm(node.bound.center - spheres[i].center) + spheres[i].radius, node.bound.radius);
    }
  }
  EXPECT_EQ(below[0].size(), spheres.size());
}

TEST(Hierarchy, EnclosesPackings) {
  const Packing packing = test::greedy_packing(test::octahedron(), 600, 40000);
  const Hierarchy tree = build_hierarchy(packing.spheres);
  expect_sound(tree, packing.spheres);
  // A tree of four children per node has this depth at most; a chain is deeper.
  EXPECT_LE(depth(tree), 10u);
}

TEST(Hierarchy, EndsForFewAndDegenerateSpheres) {
  const auto in_row = [](int count, double growth) {
    std::vector<Sphere> spheres;
    double at = 0, radius = 1;
    for (int k = 0; k < count; ++k, radius *= growth) {
      spheres.push_back({{at + radius, 0, 0}, radius});
      at += 2 * radius;
    }
    return spheres;
  };
  for (const int count : {1, 2, 3, 4, 5, 6, 17, 500}) {
    expect_sound(build_hierarchy(in_row(count, 1)), in_row(count, 1));
  }
  // Radii fall from 1 to 1e-12 and crowd in one point.
  const std::vector<Sphere> crowded = in_row(120, 0.8);
  expect_sound(build_hierarchy(crowded), crowded);
  EXPECT_LE(depth(build_hierarchy(crowded)), 40u);
  // Equal spheres, which no packing has, must not break the tree either.
  const std::vector<Sphere> equal(50, Sphere{{1, 2, 3}, 0.5});
  expect_sound(build_hierarchy(equal), equal);
}

TEST(EnclosingSphere, IsNearTheSmallest) {
  // The corners of a cube have the circumradius sqrt(3); two spheres have half their length.
  std::vector<Sphere> corners;
  for (int k = 0; k < 8; ++k) {
    corners.push_back({{k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0}, 0.1});
  }
  EXPECT_LE(enclosing_sphere(corners).radius, 1.01 * (std::sqrt(3.0) + 0.1));
  const std::vector<Sphere> two{{{0, 0, 0}, 3}, {{6, 0, 0}, 1}};
  EXPECT_LE(enclosing_sphere(two).radius, 1.01 * 5);
  const std::vector<Sphere> nested{{{0, 0, 0}, 3}, {{1, 0, 0}, 1}};
  EXPECT_LE(enclosing_sphere(nested).radius, 1.01 * 3);
  const std::vector<Sphere> one{{{1e7, 0, 0}, 0.25}};
  EXPECT_NEAR(enclosing_sphere(one).radius, 0.25, 1e-14);
}

TEST(BatchNeuralGas, SeparatesFourHeaps) {
  test::Numbers numbers(1);
  const Vec3 heaps[] = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}};
  std::vector<Sphere> spheres;
  for (int k = 0; k < 400; ++k) {
    spheres.push_back({heaps[k % 4] + numbers.uniform(0, 1) * numbers.direction(), 0.01});
  }
  const std::vector<std::uint8_t> cluster = batch_neural_gas(spheres);
  for (std::size_t a = 0; a < spheres.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      ASSERT_EQ(cluster[a] == cluster[b], a % 4 == b % 4);
    }
  }
}

}  // namespace
}  // namespace vpm
