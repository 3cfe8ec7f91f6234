#include "libvpm/mesh/outer_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "libvpm/core/parallel.h"
#include "libvpm/core/pose.h"
#include "libvpm/mesh/cut_volume.h"
#include "libvpm/mesh/triangle_cells.h"
#include "libvpm/model/sphere.h"
#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/shapes.h"
#include "libvpm/synthetic/truth.h"
#include "tests/mesh/mesh_files.h"

namespace vpm::test {
namespace {

using synthetic::make_box;
using synthetic::make_cube;
using synthetic::make_icosphere;
using synthetic::make_torus;

const Rotation kTurn = rotation_from_quaternion({0.117, 0.083, 0.151, 0.978});

Solid tilted(Solid solid) {
  for (Vec3& p : solid.vertices) p = kTurn * p;
  return solid;
}

std::vector<std::vector<Vec2>> triangle_cells(const std::vector<TriangleSegment>& segments) {
  std::uint64_t work = 0;
  return vpm::triangle_cells(segments, UINT64_MAX, work);
}

double area_of(const std::vector<std::vector<Vec2>>& cells) {
  double area = 0;
  for (const auto& cell : cells) {
    for (std::size_t k = 2; k < cell.size(); ++k) {
      area += 0.5 * ((cell[k - 1].x - cell[0].x) * (cell[k].y - cell[0].y) -
                     (cell[k - 1].y - cell[0].y) * (cell[k].x - cell[0].x));
    }
  }
  return area;
}

TEST(TriangleCells, FillTheTriangleAndNoSegmentCrossesThem) {
  std::mt19937 random(3);
  const auto coordinate = [&] { return static_cast<double>(random() % 1000) / 800 - 0.1; };
  std::vector<TriangleSegment> segments;
  for (int k = 0; k < 40; ++k)
    segments.push_back({{coordinate(), coordinate()}, {coordinate(), coordinate()}});
  const auto cells = triangle_cells(segments);
  EXPECT_NEAR(area_of(cells), 0.5, 1e-13);
  for (const auto& cell : cells) {
    for (const TriangleSegment& s : segments) {
      for (int k = 1; k < 50; ++k) {
        const double t = k / 50.0;
        const Vec2 p{s.from.x + t * (s.to.x - s.from.x), s.from.y + t * (s.to.y - s.from.y)};
        double inside = HUGE_VAL;  // least distance from an edge times the edge's length
        for (std::size_t i = 0; i < cell.size(); ++i) {
          const Vec2 a = cell[i], b = cell[(i + 1) % cell.size()];
          inside = std::min(inside, (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x));
        }
        EXPECT_LT(inside, 1e-10);
      }
    }
  }
  EXPECT_EQ(triangle_cells({}).size(), 1U);
  EXPECT_EQ(triangle_cells({{{0.2, 0.2}, {0.2, 0.2}}, {{0, 0}, {0, 1}}, {{2, 2}, {3, 1}}}).size(),
            1U);
}

TEST(EnclosedMass, IsThatOfTheMeshWhereNothingMeets) {
  for (const Solid& solid :
       {make_cube(0.3), make_torus(1, 0.3, 24, 12), tilted(make_icosphere(0.7, 2)),
        together(make_cube(2), turned_over(make_cube(1))),
        together(make_cube(2), moved(make_cube(1), {5, 0, 0}))}) {
    const MassProperties plain = mass_properties(solid), enclosed = enclosed_mass(solid);
    EXPECT_EQ(enclosed.volume, plain.volume);
    EXPECT_EQ(enclosed.center_of_mass, plain.center_of_mass);
  }
}

TEST(EnclosedMass, OverlappingBoxesCountOnce) {
  // Two arms make a cross; one arm is shorter on one side.
  const Solid cross = together(make_box(1, 0.5, 0.5), moved(make_box(0.5, 1, 0.5), {0, 0.25, 0}));
  for (const Solid& solid : {cross, tilted(cross), moved(tilted(cross), {1e3, -2e3, 5e2})}) {
    const MassProperties mass = enclosed_mass(solid);
    EXPECT_NEAR(mass.volume, 0.25 + 0.25 - 0.125, 1e-10);
  }
  const double low = -0.25, high = 0.75;              // ends of the second arm along y
  const double moment = 0.25 * (low + high) / 2 - 0;  // the overlap is centred on y = 0
  EXPECT_NEAR(enclosed_mass(cross).center_of_mass.y, moment / 0.375, 1e-14);
  EXPECT_NEAR(enclosed_mass(cross).center_of_mass.x, 0, 1e-14);
}

TEST(EnclosedMass, FacesThatCoincideBoundNothing) {
  // Bodies of different sizes are stacked, and one body is given three times.
  const Solid stack = together(make_cube(2), moved(make_cube(1), {0.2, 0.1, 1.5}));
  const Vec3 center = enclosed_mass(stack).center_of_mass;
  EXPECT_NEAR(enclosed_mass(stack).volume, 9, 1e-13);
  EXPECT_NEAR(norm(center - Vec3{0.2, 0.1, 1.5} / 9), 0, 1e-14);
  EXPECT_NEAR(enclosed_mass(tilted(stack)).volume, 9, 1e-9);
  EXPECT_NEAR(norm(enclosed_mass(tilted(stack)).center_of_mass - kTurn * center), 0, 1e-9);
  const Solid ball = tilted(make_icosphere(1, 2));
  const double volume = mass_properties(ball).volume;
  EXPECT_NEAR(enclosed_mass(together(together(ball, ball), ball)).volume, volume, 1e-9);
  // A pocket is cut flush with a face.
  const Solid pocket = together(make_cube(2), turned_over(moved(make_cube(1), {0, 0, 0.5})));
  EXPECT_NEAR(enclosed_mass(pocket).volume, 7, 1e-12);
  EXPECT_NEAR(enclosed_mass(tilted(pocket)).volume, 7, 1e-9);
}

TEST(EnclosedMass, AgreesWithALensInClosedForm) {
  const int fine = 5;  // 20480 triangles each
  const Solid a = make_icosphere(1, fine), b = moved(tilted(a), {1, 0, 0});
  const double ball = mass_properties(a).volume, d = 1;
  const double lens = kPi * (4 + d) * (2 - d) * (2 - d) / 12;
  EXPECT_NEAR(enclosed_mass(together(a, b)).volume, 2 * ball - lens, 2e-3 * lens);
  EXPECT_NEAR(enclosed_mass(together(a, turned_over(b))).volume, ball - lens, 2e-3 * lens);
}

// A cross of two boxes of 3 x 1 x 1 is cut at x = c and by a ball about its middle.
TEST(EnclosedSurface, IntegralsOverItCountOverlapsOnce) {
  const Solid cross = together(make_box(3, 1, 1), make_box(1, 3, 1));
  const Solid surface = enclosed_surface(cross);
  EXPECT_NEAR(volume_below_plane(surface, {1, 0, 0}, 0), 2.5, 1e-12);
  EXPECT_NEAR(volume_below_plane(surface, {1, 0, 0}, 1), 4.5, 1e-12);
  EXPECT_NEAR(volume_in_ball(surface, {{0, 0, 0}, 0.5}), kPi / 6, 1e-12);
  const synthetic::SurfacePtr wall = synthetic::make_wall({1, 0, 0}, {1, 0, 0});
  EXPECT_NEAR(synthetic::TrueSolid(surface).penetration({}, *wall).volume, 4.5, 1e-5);
}

TEST(EnclosedMass, ScalesByPowersOfTwoToTheBitForAnyThreads) {
  const Solid pair = together(make_icosphere(1, 3), tilted(moved(make_cube(1.3), {0.6, 0.3, 0.2})));
  set_thread_count(1);
  const MassProperties one = enclosed_mass(pair);
  set_thread_count(8);
  for (const int power : {-40, 0, 40}) {
    Solid scaled = pair;
    for (Vec3& p : scaled.vertices) p = std::ldexp(1.0, power) * p;
    EXPECT_EQ(enclosed_mass(scaled).volume, std::ldexp(one.volume, 3 * power));
    EXPECT_EQ(enclosed_mass(scaled).center_of_mass, std::ldexp(1.0, power) * one.center_of_mass);
  }
  set_thread_count(0);
}

}  // namespace
}  // namespace vpm::test
