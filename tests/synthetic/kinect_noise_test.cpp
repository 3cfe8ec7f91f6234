#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/core/parallel.h"
#include "libvpm/model/sphere.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"

namespace vpm::synthetic {
namespace {

TEST(NormalNumbers, HaveTheMomentsAndTailsOfTheNormalDistribution) {
  constexpr int kCount = 400000;
  double mean = 0, square = 0, fourth = 0;
  int beyond_two = 0;
  NormalNumbers numbers(7, 3);
  for (int k = 0; k < kCount; ++k) {
    const double x = numbers.next();
    mean += x;
    square += x * x;
    fourth += x * x * x * x;
    beyond_two += std::abs(x) > 2;
  }
  // Allows five standard errors of each estimate.
  EXPECT_NEAR(mean / kCount, 0, 5 / std::sqrt(kCount));
  EXPECT_NEAR(square / kCount, 1, 5 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(fourth / kCount, 3, 5 * std::sqrt(96.0 / kCount));
  EXPECT_NEAR(beyond_two / double{kCount}, 0.0455003, 5 * std::sqrt(0.0434 / kCount));
}

TEST(NormalNumbers, DependOnSeedAndCounterOnly) {
  EXPECT_EQ(NormalNumbers(1, 2).next(), NormalNumbers(1, 2).next());
  EXPECT_NE(NormalNumbers(1, 2).next(), NormalNumbers(2, 1).next());
  EXPECT_NE(NormalNumbers(1, 2).next(), NormalNumbers(1, 3).next());
}

TEST(KinectNoise, FollowsTheModelOfTheAuthors) {
  EXPECT_DOUBLE_EQ(axial_sigma(0.4, 0), 0.0012);
  EXPECT_DOUBLE_EQ(axial_sigma(1.4, 0.5), 0.0031);
  EXPECT_NEAR(axial_sigma(1, 70 * kPi / 180), 0.0012 + 0.0019 * 0.36 + 0.0001 * 12.25, 1e-12);
  EXPECT_DOUBLE_EQ(lateral_sigma(0), 0.8);
  EXPECT_TRUE(std::isfinite(axial_sigma(1, kPi / 2)));
}

TEST(KinectNoise, ImageOfAWallErrsAsTheModelSays) {
  const Scene scene = make_scene("wall");
  const DepthImage image = render_with_kinect_noise(*scene.surface, scene.camera, 1);
  double mean = 0, square = 0;
  for (const float z : image.depth) {
    mean += z - 1.0;
    square += (z - 1.0) * (z - 1.0);
  }
  const auto count = static_cast<double>(image.depth.size());
  EXPECT_NEAR(mean / count, 0, 5 * axial_sigma(1, 0) / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(square / count), axial_sigma(1, 0), 0.01 * axial_sigma(1, 0));
}

TEST(KinectNoise, IsTheSameForAnyThreadCountAndOtherForAnotherSeed) {
  const Scene scene = make_scene("ball");
  set_thread_count(1);
  const DepthImage one = render_with_kinect_noise(*scene.surface, scene.camera, 5);
  set_thread_count(8);
  const DepthImage eight = render_with_kinect_noise(*scene.surface, scene.camera, 5);
  set_thread_count(0);
  EXPECT_EQ(one.depth, eight.depth);
  EXPECT_NE(one.depth, render_with_kinect_noise(*scene.surface, scene.camera, 6).depth);
}

}  // namespace
}  // namespace vpm::synthetic
