#include "libvpm/query/points_inside.h"

#include <gtest/gtest.h>

#include <random>

#include "libvpm/cloud/cloud.h"

namespace vpm {
namespace {

Rotation random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Quaternion q{normal(random), normal(random), normal(random), normal(random)};
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  return rotation_from_quaternion({q.x / length, q.y / length, q.z / length, q.w / length});
}

// Rounding decides about a point that lies on the sphere; searches must leave that decision to the
// exact test.
TEST(PointsOfSphere, AreThoseThatTheExactTestTakes) {
  const Sphere sphere{{2, 1, 7}, 5};
  const Vec3 on_sphere{5, 5, 7};
  Cloud points;
  const Vec3f place{0.5F, -0.25F, 2};
  points.positions = {place};
  for (int k = 0; k < 200; ++k)  // in other leaves of the tree
    points.positions.push_back({1000 + static_cast<float>(k % 20), static_cast<float>(k / 20), 0});
  points.normals.assign(points.positions.size(), {0, 0, -1});
  points.radii.assign(points.positions.size(), 0.01F);
  const PreparedCloud cloud(points, PointReading::as_measured);
  std::mt19937_64 random(1);
  int inside = 0;
  for (int k = 0; k < 20000; ++k) {
    const Rotation rotation = random_rotation(random);
    const Pose pose{rotation, widen(place) - rotation * on_sphere};
    const bool expected =
        strictly_inside(sphere, relative_to(pose, {{}, cloud.origin()}) * widen(place));
    ASSERT_EQ(PointsOfSphere(cloud, pose).count(sphere, DiskSurface::Look{}), expected) << k;
    inside += expected;
  }
  EXPECT_GT(inside, 1000);
  EXPECT_LT(inside, 19000);
}

}  // namespace
}  // namespace vpm
