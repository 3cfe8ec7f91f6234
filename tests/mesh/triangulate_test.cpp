#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

#include "libvpm/core/error.h"
#include "libvpm/core/pose.h"
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

Vec3 on_circle(double radius, double turns) {
  const double angle = 2 * M_PI * turns;
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

double area_of(const std::vector<Vec3>& corners) {
  Vec3 sum;
  for (std::size_t k = 0; k < corners.size(); ++k)
    sum += cross(corners[k], corners[(k + 1) % corners.size()]);
  return 0.5 * norm(sum);
}

TEST(Triangulate, CutsConcavePolygonsOfManyCornersQuickly) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> radius(0.1, 1);
  for (const int count : {5, 6, 7, 8, 9, 30, 400, 4096}) {
    std::vector<Vec3> star;
    for (int k = 0; k < count; ++k)
      star.push_back(on_circle(radius(random), static_cast<double>(k) / count));
    const auto start = std::chrono::steady_clock::now();
    expect_cut_well(star, {0, 0, 1}, area_of(star));
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    EXPECT_LT(taken.count(), 2) << count;  // 0.1 s where nothing else runs
  }
}

TEST(Triangulate, CutsConvexPolygonsAsAFanAboutTheLastCorner) {
  std::vector<Vec3> round;
  for (int k = 0; k < 6; ++k) round.push_back(on_circle(1, k / 6.0));
  EXPECT_EQ(triangulate(polygon(round)),
            (std::vector<Triangle>{{5, 0, 1}, {5, 1, 2}, {5, 2, 3}, {3, 4, 5}}));
}

TEST(Triangulate, CutsPolygonsWithCornersOnOneLine) {
  // A rectangle whose long sides have corners on and next to a line.
  for (const double off : {0.0, 1e-16, 1e-12, 1e-9}) {
    std::vector<Vec3> corners;
    for (int k = 0; k <= 20; ++k) corners.push_back({0.1 * k, k % 2 == 0 ? 0 : off, 0});
    for (int k = 20; k >= 0; --k) corners.push_back({0.1 * k, 1 + (k % 3 == 0 ? 0 : off), 0});
    expect_cut_well(corners, {0, 0, 1}, area_of(corners));
    for (Vec3& p : corners) p.y *= 1e-6;
    expect_cut_well(corners, {0, 0, 1}, area_of(corners));
  }
}

// Returns a square of edge 10 with square holes, each reached by a bridge along which the polygon
// goes to and fro.
std::vector<Vec3> with_holes(int holes) {
  std::vector<Vec3> corners{{10, 10, 0}, {0, 10, 0}, {0, 0, 0}};
  for (int k = 0; k < holes; ++k) {
    const double x = 1 + 8.0 * k / holes, wide = 4.0 / holes;
    corners.push_back({x, 0, 0});
    for (const Vec3 p :
         {Vec3{x, 2, 0}, {x, 2 + wide, 0}, {x + wide, 2 + wide, 0}, {x + wide, 2, 0}, {x, 2, 0}})
      corners.push_back(p);
    corners.push_back({x, 0, 0});
  }
  corners.push_back({10, 0, 0});
  return corners;
}

TEST(Triangulate, CutsPolygonsWithHoles) {
  for (const int holes : {1, 2, 7, 300}) {
    const double wide = 4.0 / holes;
    expect_cut_well(with_holes(holes), {0, 0, 1}, 100 - holes * wide * wide);
  }
}

TEST(Triangulate, CutsPolygonsThatGoToAndFro) {
  // Goes to (5, 5) and back, and names one corner twice.
  const RawMesh mesh =
      parse("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 3 1 0\nv 0 4 0\nv -1 -1 0\nf 1 2 2 3 4 5 1 6\n", "a.obj");
  std::vector<Triangle> triangles = triangulate(mesh);
  EXPECT_EQ(triangles.size(), 3U);
}

TEST(Triangulate, RefusesPolygonsThatCrossThemselves) {
  std::vector<Vec3> pentagram;
  for (int k = 0; k < 5; ++k) pentagram.push_back(on_circle(1, 0.4 * k));
  const std::vector<Vec3> eight{{0, 0, 0}, {2, 2, 0}, {3, 2, 0}, {2, 0, 0}, {0, 2, 0}};
  // Both halves of these are equal, so that no normal is left of their sum.
  const std::vector<Vec3> bow{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}};
  const std::vector<Vec3> tilted{{0, 0, 0}, {2, 2, 1}, {2, 0, 1}, {0, 2, 0}};
  const std::vector<Vec3> other{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}};
  const std::vector<Vec3> uneven{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}};
  for (const auto& corners : {pentagram, eight, bow, tilted, other, uneven}) {
    try {
      triangulate(polygon(corners));
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what())
                    .find("a polygon of " + std::to_string(corners.size()) + " corners, from ("),
                std::string::npos);
      EXPECT_NE(std::string(error.what()).find("crosses itself"), std::string::npos);
    }
  }
}

// Returns a plate of 10 x 10 x 1 with a square hole through it; its two large faces are polygons
// that reach the hole by a bridge. Corners of the bridge are listed twice if `repeats`.
std::string plate_with_hole(bool repeats) {
  std::string obj;
  for (const int z : {0, 1}) {
    for (const char* const xy : {"0 0", "10 0", "10 10", "0 10", "3 3", "7 3", "7 7", "3 7"})
      obj += std::string("v ") + xy + " " + std::to_string(z) + "\n";
  }
  obj += "v 0 0 0\nv 3 3 0\nv 0 0 1\nv 3 3 1\n";
  obj += repeats ? "f 1 5 6 7 8 18 17 4 3 2\nf 9 10 11 12 19 20 16 15 14 13\n"
                 : "f 1 5 6 7 8 5 1 4 3 2\nf 9 10 11 12 9 13 16 15 14 13\n";
  for (int k = 1; k <= 4; ++k) {
    const int next = k % 4 + 1;
    const auto side = [&](int a, int b, int c, int d) {
      obj += "f";
      for (const int v : {a, b, c, d}) obj += " " + std::to_string(v);
      obj += "\n";
    };
    side(k, next, next + 8, k + 8);
    side(next + 4, k + 4, k + 12, next + 12);
  }
  return obj;
}

TEST(Triangulate, ASolidMayHaveFacesWithHoles) {
  for (const bool repeats : {false, true}) {
    const CheckedSolid plate = solid_of(plate_with_hole(repeats), "plate.obj");
    EXPECT_DOUBLE_EQ(plate.facts.volume, 84) << repeats;
    EXPECT_EQ(plate.facts.euler, 0) << repeats;
    EXPECT_EQ(plate.facts.turned_triangles, 0U) << repeats;
  }
}

// Returns a prism over the polygon of the corners x, y, between z = 0 and 1, turned.
std::string prism(const std::vector<Vec3>& corners, const Rotation& turn) {
  std::string obj;
  char line[120];
  for (const double z : {0.0, 1.0}) {
    for (const Vec3& corner : corners) {
      const Vec3 p = turn * Vec3{corner.x, corner.y, z};
      std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", p.x, p.y, p.z);
      obj += line;
    }
  }
  const std::size_t count = corners.size();
  obj += "f";
  for (std::size_t k = count; k > 0; --k) obj += " " + std::to_string(k);
  obj += "\nf";
  for (std::size_t k = 1; k <= count; ++k) obj += " " + std::to_string(count + k);
  obj += "\n";
  for (std::size_t k = 1; k <= count; ++k) {
    const std::size_t next = k % count + 1;
    for (const std::size_t v : {k, next, count + next, count + k})
      obj += (v == k ? "f " : " ") + std::to_string(v);
    obj += "\n";
  }
  return obj;
}

// Returns the outline of a staircase whose sides have corners on them.
std::vector<Vec3> staircase(std::mt19937& random) {
  std::uniform_int_distribution<int> steps(1, 6), parts(1, 4);
  std::vector<Vec3> corners;
  Vec3 at;
  const auto go = [&](double x, double y) {
    const int count = parts(random);
    for (int k = 0; k < count; ++k)
      corners.push_back(at + static_cast<double>(k) / count * Vec3{x - at.x, y - at.y, 0});
    at = {x, y, 0};
  };
  const int count = steps(random);
  go(count, 0);
  for (int k = 0; k < count; ++k) {
    go(count - k, k + 1);
    go(count - k - 1, k + 1);
  }
  go(0, 0);
  return corners;
}

TEST(Triangulate, AMeshIsNotBlamedForCornersOnOneLine) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 200; ++k) {
    const std::vector<Vec3> corners = staircase(random);
    Vec3 axis;
    if (k % 2 == 1) axis = {normal(random), normal(random), normal(random)};
    const Rotation turn = rotation_from_vector(axis);
    const CheckedSolid solid = solid_of(prism(corners, turn), "a.obj");
    EXPECT_EQ(solid.facts.self_intersections, 0U) << prism(corners, turn);
    EXPECT_EQ(solid.facts.zero_area_triangles, 0U) << k;
    EXPECT_NEAR(solid.facts.volume, area_of(corners), 1e-9) << k;
  }
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
