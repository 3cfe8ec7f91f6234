// Tests that normals which contradict others are found, and that turning them makes them agree.
#include "libvpm/cloud/orientation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "libvpm/core/error.h"
#include "tests/scene/scans.h"

namespace vpm {
namespace {

constexpr double kApart = 0.01;  // m

std::vector<Cloud> oriented_clouds() {
  std::vector<Cloud> clouds(6);
  add_ball(
      0.2, kApart, [](Vec3) { return true; }, clouds[0]);
  add_box({}, {0.3, 0.2, 0.1}, 1, kApart, clouds[1]);
  add_box({}, {0.3, 0.3, 0.02}, 1, kApart, clouds[2]);
  add_box({}, {0.3, 0.3, 0.3}, 1, kApart, clouds[3]);  // a box with a hollow
  add_box({}, {0.2, 0.2, 0.2}, -1, kApart, clouds[3]);
  add_torus(0.25, 0.1, kApart, clouds[4]);
  add_box({-0.1, 0, 0}, {0.2, 0.2, 0.2}, 1, kApart, clouds[5]);  // two that cross
  add_box({0.1, 0.05, 0.03}, {0.2, 0.2, 0.2}, 1, kApart, clouds[5]);
  return clouds;
}

// Moves the points by noise and turns a part of the normals. Returns the indices of these.
std::vector<std::uint32_t> disturb(double share, double noise, Cloud& cloud) {
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  std::bernoulli_distribution is_turned(share);
  std::vector<std::uint32_t> turned;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const double x = any(random), y = any(random), z = any(random);
    cloud.positions[i] = narrow(widen(cloud.positions[i]) + noise * Vec3{x, y, z});
    if (!is_turned(random)) continue;
    cloud.normals[i] = narrow(-1.0 * widen(cloud.normals[i]));
    turned.push_back(i);
  }
  return turned;
}

std::size_t count_wrong(const Cloud& cloud, const Cloud& truth) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) wrong += cloud.normals[i] != truth.normals[i];
  return wrong;
}

TEST(ContradictingNormals, AreThoseThatWereTurned) {
  for (const Cloud& truth : oriented_clouds()) {
    Cloud cloud = truth;
    EXPECT_TRUE(contradicting_normals(cloud).empty());
    const std::vector<std::uint32_t> turned = disturb(0.01, 0.1 * kApart, cloud);
    const std::vector<std::uint32_t> found = contradicting_normals(cloud);
    EXPECT_TRUE(std::ranges::includes(found, turned));
    EXPECT_LT(found.size(), 1.2 * static_cast<double>(turned.size()));
  }
}

TEST(Orientation, GivesTheNormalsBackThatWereTurned) {
  for (const Cloud& truth : oriented_clouds()) {
    for (const double share : {0.0, 0.1, 0.5, 1.0}) {
      for (const double noise : {0.0, 0.1}) {
        Cloud cloud = truth;
        const std::size_t turned = disturb(share, noise * kApart, cloud).size();
        EXPECT_EQ(orient({}, cloud), turned);
        EXPECT_EQ(count_wrong(cloud, truth), 0) << share << " " << noise;
      }
    }
  }
}

TEST(Orientation, TowardsASensorTurnsWhatFacesAwayFromIt) {
  Cloud half, truth;
  half.origin = {1, 2, 3};
  add_ball(
      0.2, kApart, [](Vec3 n) { return n.z > 0.3; }, half);
  truth = half;
  const std::size_t turned = disturb(0.5, 0, half).size();
  EXPECT_EQ(orient(orientation_from_text("1,2,5"), half), turned);
  EXPECT_EQ(count_wrong(half, truth), 0);
}

TEST(Orientation, IsToldByAWordOrAPlace) {
  EXPECT_FALSE(orientation_from_text("neighbours").sensor);
  EXPECT_EQ(orientation_from_text("1 2 3").sensor, (Vec3{1, 2, 3}));
  for (const char* const text : {"", "1,2", "1,2,3,4", "sensor"})
    EXPECT_THROW(orientation_from_text(text), Error) << text;
}

}  // namespace
}  // namespace vpm
