#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/mesh/mesh_reader.h"
#include "tests/mesh/mesh_files.h"

namespace vpm::test {
namespace {

RawMesh polygon(const std::vector<Vec3>& corners) {
  RawMesh mesh;
  mesh.name = "polygon";
  mesh.vertices = corners;
  for (std::uint32_t k = 0; k < corners.size(); ++k) mesh.corners.push_back(k);
  mesh.polygon_end = {corners.size()};
  return mesh;
}

// Expects the areas of the triangles, none of them turned over, to add up to the polygon's area.
void expect_cut_well(const std::vector<Vec3>& corners, Vec3 unit_normal, double area) {
  const std::vector<Triangle> triangles = triangulate(polygon(corners));
  EXPECT_EQ(triangles.size(), corners.size() - 2);
  double sum = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = corners[t[0]], normal = cross(corners[t[1]] - a, corners[t[2]] - a);
    EXPECT_GE(dot(normal, unit_normal), 0);
    sum += 0.5 * norm(normal);
  }
  EXPECT_NEAR(sum, area, 1e-12 * area);
}

TEST(Triangulate, CutsConcavePolygonsInAnyPlane) {
  // A fan from the arrow's first corner would leave the polygon.
  const std::vector<Vec3> arrow{{0, 0, 0}, {4, -3, 0}, {1, 0, 0}, {4, 3, 0}};
  expect_cut_well(arrow, {0, 0, 1}, 3);
  std::vector<Vec3> comb;  // its teeth make many reflex corners
  for (int k = 0; k < 10; ++k) {
    comb.push_back({2.0 * k, 0, 0});
    comb.push_back({2.0 * k + 1, 0, 5});
  }
  comb.push_back({20, 0, 0});
  comb.push_back({20, 0, -1});
  comb.push_back({0, 0, -1});
  std::vector<Vec3> backwards(comb.rbegin(), comb.rend());
  expect_cut_well(backwards, {0, -1, 0}, 70);
  const Vec3 u{0.6, 0.8, 0}, v{0, 0, 1};
  std::vector<Vec3> tilted;
  for (const Vec3& p : arrow) tilted.push_back(p.x * u + p.y * v);
  expect_cut_well(tilted, cross(u, v), 3);
}

TEST(Triangulate, ClosesWhatHasNoPlane) {
  EXPECT_EQ(triangulate(polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}})).size(),
            3U);
}

TEST(Triangulate, AQuadMeshIsASolid) {
  const CheckedSolid cube = solid_of(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n",
      "cube.obj");
  EXPECT_DOUBLE_EQ(cube.facts.volume, 1);
  EXPECT_EQ(cube.facts.triangles, 12U);
}

}  // namespace
}  // namespace vpm::test
