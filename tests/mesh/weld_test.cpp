#include "libvpm/mesh/weld.h"

#include <gtest/gtest.h>

#include <random>

namespace vpm {
namespace {

std::vector<Triangle> one_each(std::uint32_t vertices) {
  std::vector<Triangle> triangles;
  for (std::uint32_t k = 0; k + 2 < vertices; ++k) triangles.push_back({k, k + 1, k + 2});
  return triangles;
}

TEST(Weld, JoinsEqualPositionsAndSignedZeros) {
  const std::vector<Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {-0.0, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  std::vector<Triangle> triangles{{0, 1, 3}, {2, 4, 3}, {0, 2, 1}};
  const Weld done = weld(vertices, 0, triangles);
  EXPECT_EQ(done.joined_vertices, 2U);
  EXPECT_EQ(done.collapsed_triangles, 1U);
  EXPECT_EQ(triangles, (std::vector<Triangle>{{0, 1, 3}, {0, 1, 3}}));
}

// Compares with the definition, over all pairs.
TEST(Weld, JoinsToTheFirstWithinTheTolerance) {
  std::mt19937 random(2);
  std::vector<Vec3> vertices;
  const auto coordinate = [&] { return static_cast<double>(random() % 4000) / 1000 - 2; };
  for (int k = 0; k < 600; ++k) vertices.push_back({coordinate(), coordinate(), coordinate()});
  for (const double tolerance : {1e-12, 0.01, 0.2, 1.0}) {
    std::vector<std::uint32_t> expected(vertices.size());
    for (std::uint32_t k = 0; k < vertices.size(); ++k) {
      expected[k] = k;
      for (std::uint32_t other = 0; other < k; ++other) {
        if (expected[other] == other && norm(vertices[other] - vertices[k]) <= tolerance) {
          expected[k] = other;
          break;
        }
      }
    }
    std::vector<Triangle> triangles = one_each(600), same;
    for (const Triangle& t : triangles) {
      const Triangle joined{expected[t[0]], expected[t[1]], expected[t[2]]};
      if (joined[0] != joined[1] && joined[1] != joined[2] && joined[2] != joined[0])
        same.push_back(joined);
    }
    weld(vertices, tolerance, triangles);
    EXPECT_EQ(triangles, same) << tolerance;
  }
}

TEST(Weld, DropsUnusedVerticesInOrder) {
  std::vector<Vec3> vertices{{9, 9, 9}, {1, 0, 0}, {2, 0, 0}, {8, 8, 8}, {3, 0, 0}};
  std::vector<Triangle> triangles{{4, 1, 2}};
  EXPECT_EQ(drop_unused(vertices, triangles), 2U);
  EXPECT_EQ(vertices, (std::vector<Vec3>{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}}));
  EXPECT_EQ(triangles, (std::vector<Triangle>{{2, 0, 1}}));
}

}  // namespace
}  // namespace vpm
