#include "libvpm/mesh/self_intersection.h"

#include <gtest/gtest.h>

#include <random>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/predicates.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"

namespace vpm::test {
namespace {

bool meet(const std::vector<Vec3>& six) {
  return triangles_intersect(six, {0, 1, 2}, {3, 4, 5});
}

TEST(TriangleIntersection, KnowsDisjointTriangles) {
  EXPECT_TRUE(meet({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, -1}, {0.5, 0.5, 1}, {3, 3, 1}}));
  EXPECT_FALSE(meet({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 1}, {2, 0, 1}, {0, 2, 1}}));
  EXPECT_FALSE(meet({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1.5, 1.5, -1}, {1.5, 1.5, 1}, {3, 3, 1}}));
  // A corner touches from above.
  EXPECT_TRUE(meet({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, 0}, {0, 0, 1}, {1, 0, 1}}));
  // Triangles in one plane overlap, lie within each other, or lie apart.
  EXPECT_TRUE(meet({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, 0}, {3, 3, 0}, {3, 2, 0}}));
  EXPECT_TRUE(meet({{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {1, 1, 0}, {2, 1, 0}, {1, 2, 0}}));
  EXPECT_TRUE(meet({{1, 1, 0}, {2, 1, 0}, {1, 2, 0}, {0, 0, 0}, {9, 0, 0}, {0, 9, 0}}));
  EXPECT_FALSE(meet({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {1, 2, 0}}));
}

TEST(TriangleIntersection, SharedCornersAndEdgesAreNoIntersection) {
  const std::vector<Vec3> points{{0, 0, 0},     {1, 0, 0},     {0, 1, 0},
                                 {1, 1, 0.5},   {-1, -1, 0},   {-1, 0, 1},
                                 {0.4, 0.4, 0}, {0.2, 0.2, 1}, {0.2, 0.2, -1}};
  EXPECT_FALSE(triangles_intersect(points, {0, 1, 2}, {2, 1, 3}));  // an edge
  EXPECT_TRUE(triangles_intersect(points, {0, 1, 2}, {2, 1, 6}));   // folded flat
  EXPECT_FALSE(triangles_intersect(points, {0, 1, 2}, {0, 4, 5}));  // a corner
  EXPECT_TRUE(triangles_intersect(points, {0, 1, 2}, {0, 7, 8}));   // a corner, and cut
  EXPECT_TRUE(triangles_intersect(points, {0, 1, 2}, {1, 2, 0}));   // the same
}

TEST(SelfIntersection, AgreesWithAllPairs) {
  std::mt19937 random(11);
  const auto coordinate = [&] { return static_cast<double>(random() % 1000) / 100; };
  Solid soup;
  for (std::uint32_t k = 0; k < 200; ++k) {
    const Vec3 at{coordinate(), coordinate(), coordinate()};
    for (int corner = 0; corner < 3; ++corner)
      soup.vertices.push_back(at + 0.6 * Vec3{coordinate(), coordinate(), coordinate()});
    soup.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  std::vector<TrianglePair> pairs;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    for (std::size_t j = i + 1; j < soup.triangles.size(); ++j) {
      if (triangles_intersect(soup.vertices, soup.triangles[i], soup.triangles[j]))
        pairs.emplace_back(i, j);
    }
  }
  ASSERT_GT(pairs.size(), 100U);
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    EXPECT_EQ(find_self_intersections(soup.vertices, soup.triangles), pairs);
  }
  set_thread_count(0);
}

TEST(SelfIntersection, CleanMeshesHaveNone) {
  for (const Solid& solid : {synthetic::make_cube(1), synthetic::make_icosphere(1, 3),
                             synthetic::make_torus(1, 0.3, 48, 24)}) {
    EXPECT_TRUE(find_self_intersections(solid.vertices, solid.triangles).empty());
  }
}

}  // namespace
}  // namespace vpm::test
