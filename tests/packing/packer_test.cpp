#include "libvpm/packing/packer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "tests/packing/brute_force.h"
#include "tests/packing/test_solids.h"
#include "tests/refusal.h"

namespace vpm::test {
namespace {

constexpr double kRounding = 1e-11;  // relative; the packer's own margin is 1e-12

TEST(Packer, CubeIsFilledAsGeometrySays) {
  const PackResult result = pack(synthetic::make_cube(2), {.spheres = 9});
  EXPECT_NEAR(result.spheres[0].radius, 1, kRounding);
  EXPECT_LT(norm(result.spheres[0].center), kRounding);
  // Eight spheres fill the corners, between three faces and the first sphere.
  const double corner = (std::sqrt(3.0) - 1) / (std::sqrt(3.0) + 1);
  for (std::size_t i = 1; i < 9; ++i) {
    EXPECT_NEAR(result.spheres[i].radius, corner, kRounding);
    EXPECT_NEAR(norm(result.spheres[i].center), std::sqrt(3.0) * (1 - corner), 1e-9);
  }
  EXPECT_NEAR(result.coverage, kPi / 6 * (1 + 8 * corner * corner * corner), 1e-9);
}

TEST(Packer, FirstSphereIsTheInsphere) {
  const auto first = [](const Solid& solid) { return pack(solid, {.spheres = 1}).spheres.at(0); };
  EXPECT_NEAR(first(synthetic::make_tetrahedron(1)).radius, std::sqrt(6.0) / 12, kRounding);
  EXPECT_NEAR(first(synthetic::make_octahedron(1)).radius, std::sqrt(6.0) / 6, kRounding);
  const Solid ball =
      synthetic::make_icosphere(1, 3);  // symmetric, so the insphere is in the middle
  const Sphere inner = first(ball);
  EXPECT_NEAR(inner.radius, distance_to_mesh(ball, {0, 0, 0}), 1e-9);
  EXPECT_LT(norm(inner.center), 1e-4);
}

TEST(Packer, CoverageOfAGreedyPacking) {
  // The values come from an independent packer that starts from 256^3 voxels.
  const struct {
    Solid solid;
    double at_10, at_100, at_1000;
  } expected[] = {{synthetic::make_cube(1), .6076, .7427, .8377},
                  {synthetic::make_tetrahedron(1), .4959, .6807, .8000},
                  {synthetic::make_octahedron(1), .6808, .7799, .8590}};
  for (const auto& e : expected) {
    const PackResult result = pack(e.solid, {.spheres = 1000});
    double filled = 0;
    for (std::size_t i = 0; i < result.spheres.size(); ++i) {
      filled += volume(result.spheres[i]) / mass_properties(e.solid).volume;
      const double before = i + 1 == 10     ? e.at_10
                            : i + 1 == 100  ? e.at_100
                            : i + 1 == 1000 ? e.at_1000
                                            : 0;
      EXPECT_GT(filled, before - .001);
    }
    EXPECT_NEAR(result.coverage, filled, 1e-12);
  }
}

TEST(Packer, EqualSpheresOfATubeTouch) {
  const double ring = 1, tube = 0.2;
  const auto fit =
      static_cast<std::size_t>(kPi / std::asin(tube / ring));  // touching each other in a circle
  const PackResult result = pack(synthetic::make_torus(ring, tube, 240, 24), {.spheres = 2 * fit});
  std::size_t full = 0;
  for (const Sphere& s : result.spheres) full += s.radius > 0.99 * result.spheres[0].radius ? 1 : 0;
  EXPECT_GE(full,
            fit - 1);  // spheres at arbitrary places would leave a quarter of the circle empty
}

TEST(Packer, SameBytesForEveryThreadCount) {
  // So many spheres have so many blocks of room that several threads look through them.
  for (const auto& [solid, spheres] : {std::pair{random_solid(0, 1), std::size_t{300}},
                                       std::pair{synthetic::make_cube(1), std::size_t{2000}}}) {
    set_thread_count(1);
    const PackResult one = pack(solid, {.spheres = spheres});
    for (const int threads : {2, 8}) {
      set_thread_count(threads);
      EXPECT_TRUE(same_bytes(one.spheres, pack(solid, {.spheres = spheres}).spheres)) << threads;
    }
  }
  set_thread_count(0);
}

TEST(Packer, PowersOfTwoChangeTheExponentOnly) {
  const Solid solid = random_solid(3, 2);
  const std::vector<Sphere> spheres = pack(solid, {.spheres = 100}).spheres;
  for (const int k : {-40, -3, 1, 40}) {
    Solid scaled = solid;
    for (Vec3& p : scaled.vertices) p = std::ldexp(1.0, k) * p;
    std::vector<Sphere> expected = spheres;
    for (Sphere& s : expected) {
      s.center = std::ldexp(1.0, k) * s.center;
      s.radius = std::ldexp(s.radius, k);
    }
    EXPECT_TRUE(same_bytes(pack(scaled, {.spheres = 100}).spheres, expected)) << k;
  }
}

TEST(Packer, FarFromTheOriginNothingProtrudes) {
  const Solid solid = moved(random_solid(4, 1), {}, {1e6, -2e6, 5e5});
  const std::vector<Sphere> spheres = pack(solid, {.spheres = 50}).spheres;
  ASSERT_EQ(spheres.size(), 50u);
  EXPECT_LE(worst_protrusion(solid, spheres), 0);
  EXPECT_LE(worst_overlap(spheres), 0);
}

TEST(Packer, FewerSpheresAreAPrefixOfMore) {
  const Solid solid = random_solid(5, 1);
  std::vector<Sphere> many = pack(solid, {.spheres = 400}).spheres;
  for (const std::size_t n : {1u, 10u, 150u}) {
    const std::vector<Sphere> few = pack(solid, {.spheres = n}).spheres;
    EXPECT_TRUE(same_bytes(few, {many.begin(), many.begin() + static_cast<std::ptrdiff_t>(n)}));
  }
}

// One sphere fills a ball but for a shell with equal rooms, one below each vertex.
TEST(Packer, ShellAboutTheBallInABallIsFilled) {
  const Solid ball = synthetic::make_icosphere(1, 3);
  const double room = (1 - distance_to_mesh(ball, {0, 0, 0})) / 2;  // radius, with level faces
  const auto packed = [&](std::size_t spheres, int threads) {
    set_thread_count(threads);
    return pack(ball, {.spheres = spheres, .min_radius = 0.98 * room});
  };
  const PackResult some = packed(30, 1);
  ASSERT_EQ(some.spheres.size(), 30U);
  EXPECT_LE(worst_protrusion(ball, some.spheres), 0);
  EXPECT_LE(worst_overlap(some.spheres), 0);
  EXPECT_NEAR(some.spheres[1].radius, room, 0.05 * room);
  EXPECT_FALSE(some.partly_searched);
  EXPECT_TRUE(same_bytes(some.spheres, packed(30, 4).spheres));

  const PackResult all = packed(100000, 0);
  EXPECT_EQ(all.stop, StopReason::min_radius);
  for (const Vec3 vertex : ball.vertices) {
    const Vec3 center = (1 - room) * vertex;  // of a sphere of .99 room that would fit
    const auto is_in_the_way = [&](const Sphere& s) {
      return norm(s.center - center) < s.radius + 0.99 * room;
    };
    const auto first = all.spheres.begin() + 1;
    EXPECT_TRUE(std::any_of(first, all.spheres.end(), is_in_the_way));
  }
}

TEST(Packer, StopsAtTheCoverage) {
  const Solid solid = synthetic::make_cube(1);
  const PackResult result = pack(solid, {.spheres = 100000, .coverage = 0.75});
  EXPECT_EQ(result.stop, StopReason::coverage);
  EXPECT_GE(result.coverage, 0.75);
  EXPECT_LT(result.coverage - volume(result.spheres.back()), 0.75);
}

TEST(Packer, StopsAtTheSmallestRadius) {
  const Solid solid = synthetic::make_tetrahedron(1);
  const PackResult result = pack(solid, {.spheres = 100000, .min_radius = 0.02});
  EXPECT_EQ(result.stop, StopReason::min_radius);
  EXPECT_GE(result.spheres.back().radius, 0.02 * (1 - kRounding));
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 x = random.in_box({-.6, -.6, -.6}, {.6, .6, .8});
    EXPECT_LE(separation(solid, result.spheres, x, result.spheres.size()), 0.021);
  }
}

TEST(Packer, RespectsTheLargestRadius) {
  const Solid solid = synthetic::make_box(1, 0.7, 0.5);
  const PackResult result = pack(solid, {.spheres = 500, .max_radius = 0.05});
  ASSERT_EQ(result.spheres.size(), 500u);
  EXPECT_NEAR(result.spheres.front().radius, 0.05, kRounding);
  EXPECT_LE(result.spheres.front().radius, 0.05);
  EXPECT_LE(worst_protrusion(solid, result.spheres), 0);
  EXPECT_LE(worst_overlap(result.spheres), 0);
}

TEST(Packer, ThinPlateOfManyEqualSpheresStopsInTime) {
  const Solid solid = synthetic::make_box(1, 1, 0.004);
  const PackResult result = pack(solid, {.spheres = 50});
  ASSERT_EQ(result.spheres.size(), 50u);
  EXPECT_NEAR(result.spheres.back().radius, 0.002, 1e-12);
}

TEST(Packer, RefusesWhatCannotBePacked) {
  const auto kind = [](const Solid& solid, const PackOptions& options) {
    return kind_of_fault([&] { pack(solid, options); });
  };
  const Solid cube = synthetic::make_cube(1);
  EXPECT_EQ(kind(cube, {.coverage = 0}), ErrorKind::invalid_argument);
  EXPECT_EQ(kind(cube, {.coverage = 1.1}), ErrorKind::invalid_argument);
  EXPECT_EQ(kind(cube, {.inertia_error = -1}), ErrorKind::invalid_argument);
  EXPECT_EQ(kind(cube, {.min_radius = -1}), ErrorKind::invalid_argument);
  EXPECT_EQ(kind(cube, {.min_radius = std::nan("")}), ErrorKind::invalid_argument);
  EXPECT_EQ(kind(cube, {.max_radius = 0}), ErrorKind::invalid_argument);
  EXPECT_EQ(kind(cube, {.min_radius = 2, .max_radius = 1}), ErrorKind::invalid_argument);
  EXPECT_EQ(kind({}, {}), ErrorKind::refused);
  EXPECT_EQ(kind(reversed(cube), {}), ErrorKind::refused);
  Solid broken = cube;
  broken.vertices[0].x = std::nan("");
  EXPECT_EQ(kind(broken, {}), ErrorKind::refused);
  Solid point = cube;
  for (Vec3& p : point.vertices) p = {1, 2, 3};
  EXPECT_EQ(kind(point, {}), ErrorKind::refused);
  Solid dangling = cube;
  dangling.triangles[0][0] = 99;
  EXPECT_EQ(kind(dangling, {}), ErrorKind::refused);
}

}  // namespace
}  // namespace vpm::test
