#include "libvpm/packing/fill_quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libvpm/core/parallel.h"
#include "libvpm/packing/packer.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/packing/test_solids.h"

namespace vpm::test {
namespace {

double error_of(const Solid& solid, const std::vector<Sphere>& spheres) {
  InertiaError error(solid);
  for (const Sphere& s : spheres) error.add(s);
  return error.value();
}

TEST(Inertia, SecondMomentsOfABox) {
  const double a = 1, b = 2, c = 3, volume = a * b * c;
  const SecondMoments m = second_moments(moved(synthetic::make_box(a, b, c), {}, {5, -7, 9}));
  EXPECT_NEAR(m[0], volume * a * a / 12, 1e-12);
  EXPECT_NEAR(m[1], volume * b * b / 12, 1e-12);
  EXPECT_NEAR(m[2], volume * c * c / 12, 1e-12);
  for (int k = 3; k < 6; ++k) EXPECT_NEAR(m[k], 0, 1e-12);
}

TEST(Inertia, SecondMomentsTurnWithTheSolid) {
  // A box turned by 45 degrees about z has xx = yy = the mean of both, and xy = half of their
  // difference.
  const double h = std::sqrt(0.5);
  const Rotation turn = rotation_from_quaternion({0, 0, std::sin(kPi / 8), std::cos(kPi / 8)});
  const SecondMoments m = second_moments(moved(synthetic::make_box(2, 1, 1), turn, {1, 1, 1}));
  EXPECT_NEAR((turn * Vec3{1, 0, 0}).y, h, 1e-15);
  EXPECT_NEAR(m[0], 2 * (4 + 1) / 24.0, 1e-12);
  EXPECT_NEAR(m[1], m[0], 1e-12);
  EXPECT_NEAR(m[3], 2 * (4 - 1) / 24.0, 1e-12);
}

TEST(Inertia, ErrorOfOneSphereInACube) {
  // Per volume the moments are 2/5 r^2 and a^2/6, the same for all axes.
  const Solid cube = synthetic::make_cube(2);
  EXPECT_NEAR(error_of(cube, {{{0, 0, 0}, 1}}), 1 - 0.4 / (4.0 / 6), 1e-12);
  // A shifted sphere has d^2 more about two axes, which can make up for a deficit about those two
  // only.
  const double ixx = 0.4 * 0.25 - 4.0 / 6, iyy = ixx + 0.25;
  EXPECT_NEAR(error_of(cube, {{{.5, 0, 0}, .5}}),
              std::sqrt(ixx * ixx + 2 * iyy * iyy) / (std::sqrt(3.0) * 4.0 / 6), 1e-12);
  EXPECT_EQ(error_of(cube, {}), 1);
}

TEST(Inertia, ErrorOfABallIsThatOfItsFacets) {
  EXPECT_LT(error_of(synthetic::make_icosphere(1, 5), {{{0, 0, 0}, 1}}), 2e-3);
}

TEST(Inertia, ErrorFallsAndStopsThePacker) {
  const Solid solid = random_solid(4, 3);
  const PackResult result = pack(solid, {.spheres = 10000, .inertia_error = 0.01});
  EXPECT_EQ(result.stop, StopReason::inertia_error);
  std::vector<Sphere> spheres = result.spheres;
  EXPECT_LE(error_of(solid, spheres), 0.01);
  spheres.pop_back();
  EXPECT_GT(error_of(solid, spheres), 0.01);
}

// Two boxes that overlap by a third have the inertia of one long box.
TEST(Inertia, OverlapsCountOnce) {
  const Solid box = synthetic::make_box(2, 1, 1);
  const Solid pair =
      joined(moved(box, Rotation{}, {-0.5, 0, 0}), moved(box, Rotation{}, {0.5, 0, 0}));
  const std::vector<Sphere> spheres{{{-0.8, 0.1, 0}, 0.4}, {{0.6, 0, 0}, 0.5}};
  EXPECT_NEAR(error_of(pair, spheres), error_of(synthetic::make_box(3, 1, 1), spheres), 1e-12);
}

TEST(Inertia, OtherLimitsComeFirst) {
  const Solid solid = random_solid(4, 3);
  EXPECT_EQ(pack(solid, {.spheres = 5, .inertia_error = 1e-6}).stop, StopReason::spheres);
  EXPECT_EQ(pack(solid, {.coverage = .1, .inertia_error = 1e-6}).stop, StopReason::coverage);
}

}  // namespace

}  // namespace vpm::test

namespace vpm {
namespace {

using synthetic::make_cube;

TEST(SurfaceGap, OfTheBallInACube) {
  const SurfaceGap gap = surface_gap(make_cube(2), {{{0, 0, 0}, 1}});
  // Over a face at distance 1 the gap is sqrt(1 + u^2 + v^2) - 1.
  constexpr int kAcross = 1000;
  std::vector<double> gaps;
  double mean = 0;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const double u = (i + 0.5) / kAcross, v = (j + 0.5) / kAcross;
      gaps.push_back(std::sqrt(1 + u * u + v * v) - 1);
      mean += gaps.back() / (kAcross * kAcross);
    }
  }
  std::sort(gaps.begin(), gaps.end());
  EXPECT_NEAR(gap.mean, mean, 1e-4);
  EXPECT_NEAR(gap.p95, gaps[kAcross * kAcross * 95 / 100], 1e-3);
  EXPECT_NEAR(gap.largest, std::sqrt(3.0) - 1, 1e-15);
}

TEST(SurfaceGap, SpheresThatReachOutLeaveNone) {
  const SurfaceGap gap = surface_gap(make_cube(2), {{{0, 0, 0}, 2}, {{0.1, 0, 0}, 0.1}});
  EXPECT_EQ(gap.mean, 0);
  EXPECT_EQ(gap.largest, 0);
}

TEST(SurfaceGap, ScalesAndDoesNotDependOnThreads) {
  const std::vector<Sphere> spheres{{{0.4, 0, 0}, 0.5}, {{-0.5, 0.2, 0}, 0.3}};
  set_thread_count(1);
  const SurfaceGap one = surface_gap(make_cube(2), spheres);
  set_thread_count(8);
  std::vector<Sphere> large = spheres;
  for (Sphere& s : large) s = {0x1p20 * s.center, 0x1p20 * s.radius};
  const SurfaceGap scaled = surface_gap(make_cube(0x1p21), large);
  set_thread_count(0);
  EXPECT_EQ(scaled.p95, 0x1p20 * one.p95);
  EXPECT_EQ(scaled.mean, 0x1p20 * one.mean);
  EXPECT_EQ(scaled.largest, 0x1p20 * one.largest);
}

}  // namespace
}  // namespace vpm
