#include "libvpm/mesh/triangle_bvh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "libvpm/core/error.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm {
namespace {

double uniform(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
}
Vec3 anywhere(std::mt19937_64& engine, double size) {
  const double x = uniform(engine, -size, size), y = uniform(engine, -size, size);
  return {x, y, uniform(engine, -size, size)};
}

TEST(ClosestPoint, CornersEdgesAndFace) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
  EXPECT_EQ(closest_point_on_triangle({1, 1, 5}, a, b, c), (Vec3{1, 1, 0}));
  EXPECT_EQ(closest_point_on_triangle({-1, -2, 5}, a, b, c), a);
  EXPECT_EQ(closest_point_on_triangle({9, -1, 0}, a, b, c), b);
  EXPECT_EQ(closest_point_on_triangle({1, -3, 1}, a, b, c), (Vec3{1, 0, 0}));
  EXPECT_EQ(closest_point_on_triangle({4, 4, -1}, a, b, c), (Vec3{2, 2, 0}));
}

TEST(ClosestPoint, DegenerateTrianglesAreTheirEdges) {
  const Vec3 a{0, 0, 0}, b{2, 0, 0}, c{1, 0, 0};
  EXPECT_EQ(closest_point_on_triangle({0.5, 3, 0}, a, b, c), (Vec3{0.5, 0, 0}));
  EXPECT_EQ(closest_point_on_triangle({0.5, 3, 0}, a, a, a), a);
  const Vec3 almost{1, 1e-13, 0};
  EXPECT_NEAR(norm(closest_point_on_triangle({0.5, 3, 0}, a, b, almost) - Vec3{0.5, 0, 0}), 0,
              1e-12);
}

TEST(ClosestPoint, NoSampleOfTheTriangleIsNearer) {
  std::mt19937_64 engine(1);
  for (int round = 0; round < 300; ++round) {
    const double thin = std::pow(10, uniform(engine, -8, 0));
    const Vec3 a = anywhere(engine, 1), b = anywhere(engine, 1);
    const Vec3 c = a + uniform(engine, -1, 2) * (b - a) + thin * anywhere(engine, 1);
    const Vec3 x = anywhere(engine, 2);
    const Vec3 p = closest_point_on_triangle(x, a, b, c);
    for (int k = 0; k < 100; ++k) {
      double u = uniform(engine, 0, 1), v = uniform(engine, 0, 1);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      EXPECT_LE(norm(x - p), norm(x - (a + u * (b - a) + v * (c - a))) + 1e-14);
    }
  }
}

// Four triangles processed together give the bits of each alone.
TEST(TriangleBvh, ALeafHasTheBitsOfItsTriangles) {
  std::mt19937_64 engine(5);
  for (int round = 0; round < 3000; ++round) {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t t = 0; t < 1 + static_cast<std::uint32_t>(round) % 4; ++t) {
      const double thin = round % 7 == 0 ? 0 : std::pow(10, uniform(engine, -12, 0));
      const Vec3 a = anywhere(engine, 1), b = round % 11 == 0 ? a : anywhere(engine, 1);
      const Vec3 c = a + uniform(engine, -1, 2) * (b - a) + thin * anywhere(engine, 1);
      vertices.insert(vertices.end(), {a, b, c});
      triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const TriangleBvh bvh(vertices, triangles);
    for (int k = 0; k < 20; ++k) {
      const Vec3 x = k % 5 == 0 ? vertices[0] + 1e-9 * anywhere(engine, 1) : anywhere(engine, 2);
      SurfacePoint best;
      double best2 = HUGE_VAL;
      for (const TriangleBvh::Corners& t : bvh.corners()) {
        const Vec3 p = closest_point_on_triangle(x, t.a, t.b, t.c);
        if (squared_norm(x - p) < best2) best2 = squared_norm(x - p), best = {p, 0, t.triangle};
      }
      const SurfacePoint found = bvh.closest(x);
      EXPECT_EQ(found.point, best.point);
      EXPECT_EQ(found.triangle, best.triangle);
      EXPECT_EQ(found.distance, std::sqrt(best2));
    }
  }
}

TEST(TriangleBvh, AgreesWithEveryTriangle) {
  std::mt19937_64 engine(2);
  for (const double scale : {1e-9, 1.0, 1e9}) {
    for (const Vec3 shift : {Vec3{}, Vec3{1e4, -3e4, 2e4}}) {
      Solid solid = synthetic::make_torus(0.5, 0.2, 40, 17);
      for (Vec3& p : solid.vertices) p = scale * (p + shift);
      const TriangleBvh bvh(solid.vertices, solid.triangles);
      for (int k = 0; k < 300; ++k) {
        const Vec3 x = scale * (anywhere(engine, 1.5) + shift);
        double nearest = HUGE_VAL;
        for (const auto& [a, b, c] : solid.triangles)
          nearest = std::min(
              nearest, norm(x - closest_point_on_triangle(x, solid.vertices[a], solid.vertices[b],
                                                          solid.vertices[c])));
        const SurfacePoint found = bvh.closest(x);
        EXPECT_EQ(found.distance, nearest);
        const auto [a, b, c] = solid.triangles[found.triangle];
        EXPECT_EQ(found.point, closest_point_on_triangle(x, solid.vertices[a], solid.vertices[b],
                                                         solid.vertices[c]));
        EXPECT_EQ(bvh.closest(x, 1.001 * nearest).triangle, found.triangle);
        EXPECT_EQ(bvh.closest(x, 0.999 * nearest).triangle, SurfacePoint::kNone);
      }
    }
  }
}

TEST(TriangleBvh, CopiesOfOneTriangleAreNoTrouble) {
  const std::vector<Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const TriangleBvh bvh(vertices, std::vector<Triangle>(1000, Triangle{0, 1, 2}));
  EXPECT_EQ(bvh.closest({0.25, 0.25, 2}).distance, 2);
}

TEST(TriangleBvh, RefusesWhatIsNoMesh) {
  EXPECT_THROW(TriangleBvh({}, {}), Error);
  EXPECT_THROW(TriangleBvh({{0, 0, 0}}, {{0, 0, 1}}), Error);
  EXPECT_THROW(TriangleBvh({{0, 0, HUGE_VAL}}, {{0, 0, 0}}), Error);
}

}  // namespace
}  // namespace vpm
