#include "libvpm/view/pose_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace vpm::view {
namespace {

std::vector<Vec3> random_places(int count, unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<double>(random() >> 8) / (1 << 24); };
  std::vector<Vec3> places;
  for (int k = 0; k < count; ++k) places.push_back({number(), number(), number()});
  return places;
}

TEST(PosePath, RandomPlacesAreNone) {
  for (unsigned seed = 1; seed <= 20; ++seed)
    for (const int count : {16, 40, 300}) EXPECT_FALSE(is_path(random_places(count, seed)));
}

TEST(PosePath, MotionsAreOne) {
  std::vector<Vec3> line, spiral, zigzag;
  for (int k = 0; k < 300; ++k) {
    const double t = 0.02 * k;
    line.push_back({t, 2 * t, -t});
    spiral.push_back({std::cos(5 * t), std::sin(5 * t), 0.3 * t});
    zigzag.push_back({(k / 20 % 2 == 0 ? k % 20 : 19 - k % 20) * 0.01, k / 20 * 0.02, 1});
  }
  EXPECT_TRUE(is_path(line));
  EXPECT_TRUE(is_path(spiral));
  EXPECT_TRUE(is_path(zigzag));
}

TEST(PosePath, TurnsAtOnePlaceAndFewPosesAreOne) {
  EXPECT_TRUE(is_path({}));
  EXPECT_TRUE(is_path(std::vector<Vec3>(1, Vec3{1, 2, 3})));
  EXPECT_TRUE(is_path(std::vector<Vec3>(50, Vec3{1, 2, 3})));
  EXPECT_TRUE(is_path(std::vector<Vec3>{{0, 0, 0}, {5, 0, 0}}));
}

TEST(PosePath, DependsOnTheOrder) {
  std::vector<Vec3> line;
  for (int k = 0; k < 50; ++k) line.push_back({0.01 * (k * 17 % 50), 0, 0});
  EXPECT_FALSE(is_path(line));
}

}  // namespace
}  // namespace vpm::view
