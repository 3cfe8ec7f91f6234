#include "libvpm/backend/cpu/points_inside.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "libvpm/cloud/cloud.h"
#include "libvpm/scene/points/prepared_points.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

Rotation random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Quaternion q{normal(random), normal(random), normal(random), normal(random)};
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  return rotation_from_quaternion({q.x / length, q.y / length, q.z / length, q.w / length});
}

// Rounding decides about a point that lies on the sphere; searches must leave that decision to the
// exact test.
TEST(PointsInside, AreThoseThatTheExactTestTakes) {
  const ToolModel tool = testing::lattice_cube(10, 1, 1);
  const Sphere sphere = tool.spheres[0];
  const Vec3 on_sphere{3, 4, 0};
  ASSERT_EQ(sphere.radius, 5);
  Cloud points;
  const Vec3f place{0.5F, -0.25F, 2};
  points.positions = {place};
  for (int k = 0; k < 200; ++k)  // in other leaves of the tree
    points.positions.push_back({1000 + static_cast<float>(k % 20), static_cast<float>(k / 20), 0});
  points.normals.assign(points.positions.size(), {0, 0, -1});
  points.radii.assign(points.positions.size(), 0.01F);
  const PreparedPoints cloud(points, Denoising::off);
  std::mt19937_64 random(1);
  PointRanges ranges;
  std::uint32_t inside = 0;
  for (int k = 0; k < 20000; ++k) {
    const Rotation rotation = random_rotation(random);
    const Pose pose{rotation, widen(place) - rotation * on_sphere};
    const bool expected =
        strictly_inside(sphere, relative_to(pose, {{}, cloud.origin()}) * widen(place));
    ASSERT_EQ(for_points_inside(cloud, tool, tool.levels[0], pose, ranges,
                                [](std::uint32_t, std::uint32_t, Vec3) {}),
              expected)
        << k;
    inside += expected;
  }
  EXPECT_GT(inside, 1000U);
  EXPECT_LT(inside, 19000U);
}

// Calls visit(index) for every sphere that holds x, by the paper's Algorithm 1.
template <class Visit>
void for_spheres_in_tree(const Hierarchy& tree, const std::vector<Sphere>& spheres, Vec3 x,
                         const Visit& visit, std::uint32_t node_index = 0) {
  const HierarchyNode& node = tree.nodes[node_index];
  if (!strictly_inside(node.bound, x)) return;
  for (std::uint32_t k = node.begin; k < node.end; ++k) {
    if (node.children_are_leaves == 0)
      for_spheres_in_tree(tree, spheres, x, visit, k);
    else if (strictly_inside(spheres[tree.leaves[k]], x))
      visit(tree.leaves[k]);
  }
}

TEST(PointLocation, GridAndHierarchyFindTheSameSpheres) {
  const ToolModel tool = testing::lattice_cube(0.2, 9, 1);
  const Level& level = tool.levels[0];
  const GridView grid = view_of(level.grid);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> coordinate(-0.12, 0.12);  // beyond the cube too
  int held = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 x{coordinate(random), coordinate(random), coordinate(random)};
    std::vector<std::uint32_t> by_grid, by_tree;
    for_spheres_at(grid, tool.spheres.data(), x,
                   [&](std::uint32_t sphere) { by_grid.push_back(sphere); });
    for_spheres_in_tree(level.hierarchy, tool.spheres, x,
                        [&](std::uint32_t sphere) { by_tree.push_back(sphere); });
    std::sort(by_tree.begin(), by_tree.end());
    ASSERT_EQ(by_grid, by_tree) << k;
    held += !by_grid.empty();
  }
  EXPECT_GT(held, 5000);
}

}  // namespace
}  // namespace vpm
