#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libvpm/core/parallel.h"
#include "libvpm/packing/fill_quality.h"
#include "libvpm/synthetic/shapes.h"

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
