// What a prepared surface answers: closest points, depths, and how much memory it takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "libvpm/solid/surface_tree.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

double least_distance(const SurfaceTree& tree, Vec3 x) {
  double least = HUGE_VAL;
  for (std::uint32_t t = 0; t < tree.triangles().size(); ++t) {
    const auto [a, b, c] = tree.corners(t);
    least = std::min(least, norm(x - closest_point_on_triangle(x, a, b, c)));
  }
  return least;
}

// Asks for the closest point at random places in a cube, and just within and beyond its distance.
void expect_closest(const SurfaceTree& tree, double half, int places) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-half, half);
  for (int k = 0; k < places; ++k) {
    const Vec3 x{place(random), place(random), place(random)};
    const double distance = least_distance(tree, x), error = 1e-12 * (distance + half);
    const SurfacePoint found = tree.closest(x);
    ASSERT_NE(found.triangle, SurfacePoint::kNone);
    EXPECT_NEAR(found.distance, distance, error);
    EXPECT_NEAR(norm(x - found.point), distance, error);
    const auto [a, b, c] = tree.corners(found.triangle);
    EXPECT_NEAR(norm(found.point - closest_point_on_triangle(x, a, b, c)), 0, error);
    EXPECT_EQ(tree.closest(x, .999 * distance).triangle, SurfacePoint::kNone);
    EXPECT_NEAR(tree.closest(x, 1.001 * distance).distance, distance, error);
  }
}

TEST(SolidSurface, ClosestPointsAreThoseOfAllTriangles) {
  using namespace synthetic;
  for (const Solid& solid :
       {make_torus(.4, .15, 48, 24), make_box(1, 1, .001), make_icosphere(.5, 3),
        make_torus_knot(2, 3, .35, .14, .07, 90, 8), make_tetrahedron(1)}) {
    const auto prepared = test::surface(solid);
    for (const double half : {.5, 20.0}) expect_closest(prepared->tree(), half, 60);
  }
}

// Each triangle is a little smaller than the one before it and nearer to a point, so that the best
// splits cut off a few at a time: a tree made of them alone would be hundreds of levels deep.
TEST(SolidSurface, TreesOfShrinkingTrianglesStayShallow) {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  double size = 1;
  for (std::uint32_t k = 0; k < 3000; ++k, size *= .9) {
    for (const Vec3 corner : {Vec3{1, 0, 0}, Vec3{1, .05, 0}, Vec3{1, 0, .05}})
      vertices.push_back(size * corner);
    triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  const SurfaceTree tree(vertices, triangles, 1.1, false);
  std::size_t most = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    std::size_t levels = 1;
    for (std::uint32_t k = tree.parent_of(t); k != 0; k = tree.node_above(k)) ++levels;
    most = std::max(most, levels);
  }
  EXPECT_LE(most, SurfaceTree::kMostLevels);
  expect_closest(tree, 1, 100);
}

// Deep below a face the depth is that of its plane, also where the grid tells it.
TEST(SolidSurface, DepthsBelowAFaceAreThoseOfItsPlane) {
  const auto box = test::surface(synthetic::make_box(2, 2, 1), true);
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> across(-.4, .4), below(0, .3);
  for (int k = 0; k < 500; ++k) {
    const double depth = below(random);
    const Depth found = box->depth({across(random), across(random), .5 - depth});
    EXPECT_NEAR(found.value, depth, 1e-6);
    EXPECT_NEAR(found.gradient.z, -1, 1e-5);
    EXPECT_NEAR(std::hypot(found.gradient.x, found.gradient.y), 0, 1e-5);
  }
}

// Returns a solid whose triangles are parted in four as often.
Solid parted(Solid solid, int times) {
  for (; times > 0; --times) {
    Solid finer;
    for (const auto& [i, j, k] : solid.triangles) {
      const Vec3 a = solid.vertices[i], b = solid.vertices[j], c = solid.vertices[k];
      const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
      for (const std::array<Vec3, 3>& part : {std::array{a, ab, ca}, std::array{ab, b, bc},
                                              std::array{ca, bc, c}, std::array{ab, bc, ca}}) {
        const auto first = static_cast<std::uint32_t>(finer.vertices.size());
        finer.vertices.insert(finer.vertices.end(), part.begin(), part.end());
        finer.triangles.push_back({first, first + 1, first + 2});
      }
    }
    solid = finer;
  }
  return solid;
}
// Returns a solid as a file holds it whose numbers have 24 bits, turned.
Solid as_in_a_file(Solid solid, const Rotation& turn) {
  for (Vec3& v : solid.vertices) v = widen(narrow(turn * v));
  return solid;
}

// Only solids that are convex and have few faces have planes that tell the depth.
TEST(SolidSurface, KnowsThePlanesOfConvexSolidsWithFewFaces) {
  const Solid cube = synthetic::make_cube(.1), plate = synthetic::make_box(1, 1, .001);
  std::mt19937_64 random(7);
  for (const Solid& solid : {cube, plate, parted(cube, 4), parted(plate, 3),
                             synthetic::make_tetrahedron(1), synthetic::make_octahedron(1e-6)}) {
    for (const bool is_turned : {false, true}) {
      const Rotation turn = test::random_pose(random, 0).rotation;
      const auto found = test::surface(is_turned ? as_in_a_file(solid, turn) : solid, true);
      EXPECT_TRUE(found->face_planes()) << solid.triangles.size();
      EXPECT_LE(found->bytes(), 1000 * found->triangles() + 10000);
    }
  }
  Solid hollow = cube, beside = cube, across = cube;
  test::append(hollow, test::turned(synthetic::make_cube(.05)));
  test::append(beside, cube, {.2, 0, 0});
  test::append(across, cube, {.05, .05, .05});
  Solid dented = parted(cube, 1);
  for (Vec3& v : dented.vertices)
    if (v == Vec3{.05, 0, 0}) v.x -= 1e-4;
  for (const Solid& solid : {hollow, dented, beside, across, synthetic::make_icosphere(.1, 2),
                             synthetic::make_torus(.4, .1, 8, 4)}) {
    const auto found = test::surface(solid, true);
    EXPECT_FALSE(found->face_planes()) << solid.triangles.size();
    EXPECT_TRUE(found->has_depth());
  }
}

// Depths, and where balls are, are those of the nearest place of the surface, by planes as well.
TEST(SolidSurface, PlanesTellWhatTheNearestPlaceTells) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> size(0, .5);
  for (const Solid& solid : {synthetic::make_box(1, .8, .1), synthetic::make_octahedron(1)}) {
    const auto found = test::surface(solid, true);
    ASSERT_TRUE(found->face_planes());
    for (int k = 0; k < 2000; ++k) {
      const Vec3 x = test::random_pose(random, 1).translation;
      const Depth nearest = found->exact_depth(x), told = found->depth(x);
      EXPECT_NEAR(told.value, nearest.value, 1e-9);
      const double radius = size(random);
      if (std::abs(std::abs(nearest.value) - radius) < 1e-8) continue;
      EXPECT_EQ(found->state_of(x, radius), nearest.value > radius    ? SphereState::inside
                                            : nearest.value < -radius ? SphereState::outside
                                                                      : SphereState::boundary);
    }
  }
}

TEST(SolidSurface, TakesLittleMemory) {
  const auto fine = test::surface(synthetic::make_icosphere(.05, 6), true);
  ASSERT_EQ(fine->triangles(), 81920);
  EXPECT_LE(fine->bytes(), 30e6);
  for (const Solid& solid : {synthetic::make_torus(.4, .15, 84, 42),
                             synthetic::make_torus_knot(2, 3, .035, .014, .007, 290, 12)}) {
    const auto prepared = test::surface(solid, true);
    ASSERT_NEAR(static_cast<double>(prepared->triangles()), 7000, 100);
    EXPECT_LE(prepared->bytes(), 2e6);
  }
}

}  // namespace
}  // namespace vpm
