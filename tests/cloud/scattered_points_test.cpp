#include "libvpm/cloud/scattered_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

struct Patch {
  std::vector<Vec3> positions, normals;
};

Patch square_grid(int side, double spacing) {
  Patch patch;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      patch.positions.push_back({x * spacing, y * spacing, 0});
      patch.normals.push_back({0, 0, 2});
    }
  }
  return patch;
}

Cloud cloud_of(const Patch& patch, const Pose& pose = {}) {
  return cloud_of_scattered_points(patch.positions, patch.normals, pose, "patch");
}

TEST(ScatteredPoints, DisksCoverAGridAndStayNearIt) {
  const double spacing = 0.01;
  const Cloud cloud = cloud_of(square_grid(20, spacing));
  validate(cloud, "cloud");
  EXPECT_FALSE(cloud.sensor);
  for (const float radius : cloud.radii) {
    EXPECT_GT(radius, spacing * std::sqrt(0.5));
    EXPECT_LT(radius, 3 * spacing);
  }
}

TEST(ScatteredPoints, DependNeitherOnOrderNorOnRepetitionNorOnThreads) {
  Patch patch = square_grid(40, 0.01);
  std::mt19937 generator(3);
  for (Vec3& p : patch.positions) p.z = static_cast<double>(generator()) * 1e-12;
  set_thread_count(1);
  const Cloud expected = cloud_of(patch);
  set_thread_count(0);
  std::vector<std::size_t> order(patch.positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), generator);
  Patch shuffled;
  for (int repetition = 0; repetition < 2; ++repetition) {
    for (const std::size_t i : order) {
      shuffled.positions.push_back(patch.positions[i]);
      shuffled.normals.push_back(patch.normals[i]);
    }
  }
  const Cloud found = cloud_of(shuffled);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::size_t i = order[k % order.size()];
    ASSERT_EQ(found.positions[k], expected.positions[i]);
    ASSERT_EQ(found.radii[k], expected.radii[i]);
  }
}

TEST(ScatteredPoints, KeepTheirDigitsFarAway) {
  const Patch patch = square_grid(10, 0.01);
  const Cloud here = cloud_of(patch), there = cloud_of(patch, {{}, {1e7, 1e7, -1e7}});
  for (std::size_t k = 0; k < here.size(); ++k)
    EXPECT_LT(norm(widen(here.positions[k]) - widen(there.positions[k])), 4e-9);
}

TEST(ScatteredPoints, AStrayPointHasNoGiantDisk) {
  Patch patch = square_grid(20, 0.01);
  patch.positions.push_back({5, 5, 5});
  patch.normals.push_back({0, 0, 1});
  const Cloud cloud = cloud_of(patch);
  EXPECT_LT(*std::max_element(cloud.radii.begin(), cloud.radii.end()), 0.15);
}

TEST(ScatteredPoints, PointsWithoutPlaceOrDirectionAreLeftOut) {
  Patch patch = square_grid(4, 0.01);
  patch.positions[0].x = std::nan("");
  patch.normals[1] = {0, 0, 0};
  patch.normals[2].y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cloud_of(patch).size(), 13U);
}

TEST(ScatteredPoints, RefuseWhatHasNoSpacing) {
  EXPECT_THROW(cloud_of({{{1, 2, 3}, {1, 2, 3}}, {{0, 0, 1}, {0, 0, 1}}}), Error);
  EXPECT_THROW(cloud_of({{{1, 2, 3}}, {{0, 0, 0}}}), Error);
  EXPECT_THROW(cloud_of({{{-1e300, 0, 0}, {1e300, 0, 0}}, {{0, 0, 1}, {0, 0, 1}}}), Error);
  const Cloud two = cloud_of({{{0, 0, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, 0, 1}}});
  EXPECT_NEAR(two.radii[0], kRadiusOfSpacing, 1e-6);
}

}  // namespace
}  // namespace vpm
