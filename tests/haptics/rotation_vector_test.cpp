#include <gtest/gtest.h>

#include "libvpm/core/pose.h"

namespace vpm {
namespace {

double difference(const Rotation& a, const Rotation& b) {
  return norm(a.row0 - b.row0) + norm(a.row1 - b.row1) + norm(a.row2 - b.row2);
}

TEST(RotationVector, GoesThereAndBack) {
  for (const Vec3 v : {Vec3{}, Vec3{1e-9, 0, 0}, Vec3{0.3, -1.2, 2.0}, Vec3{0, 0, 3.14}}) {
    EXPECT_LE(norm(rotation_vector(rotation_from_vector(v)) - v), 1e-12) << v.x << ' ' << v.z;
  }
}

TEST(RotationVector, InterpolatesAlongTheShortestTurn) {
  const Rotation from = rotation_from_vector({0.2, 0.1, -0.4});
  const Rotation to = rotation_from_vector({-0.5, 0.9, 0.3});
  EXPECT_LE(difference(interpolate(from, to, 0), from), 1e-14);
  EXPECT_LE(difference(interpolate(from, to, 1), to), 1e-14);
  const Rotation half = interpolate(from, to, 0.5);
  EXPECT_LE(difference(half * transpose(from) * half, to), 1e-14);
}

}  // namespace
}  // namespace vpm
