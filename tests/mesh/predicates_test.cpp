#include "libvpm/mesh/predicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

namespace vpm {
namespace {

__extension__ using Int128 = __int128;

int sign(Int128 x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

TEST(Predicates, KnowSimpleCases) {
  EXPECT_EQ(orientation(Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}), 1);
  EXPECT_EQ(orientation(Vec2{0, 0}, Vec2{0, 1}, Vec2{1, 0}), -1);
  EXPECT_EQ(orientation(Vec2{0, 0}, Vec2{1, 1}, Vec2{3, 3}), 0);
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  EXPECT_EQ(orientation(a, b, c, Vec3{0, 0, -1}), 1);
  EXPECT_EQ(orientation(a, b, c, Vec3{0, 0, 1}), -1);
  EXPECT_EQ(orientation(a, b, c, Vec3{5, 7, 0}), 0);
}

// Integers of 30 bits are exact in doubles, and their determinants in 128-bit integers.
TEST(Predicates, AgreeWithIntegersNearThePlane) {
  std::mt19937 random(3);
  const auto integer = [&](std::int64_t range) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(2 * range + 1)) - range;
  };
  struct P {
    std::int64_t x, y, z;
  };
  const auto real = [](const P& p) {
    return Vec3{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  };
  constexpr std::int64_t kRange = 1 << 28;
  int zeros = 0;
  for (int round = 0; round < 20000; ++round) {
    const P d{integer(kRange), integer(kRange), integer(kRange)};
    const P u{integer(kRange), integer(kRange), integer(kRange)};
    const P v{integer(kRange), integer(kRange), integer(kRange)};
    // Three points lie in the plane of d, u, v, one of them off it by at most a unit.
    const auto in_plane = [&](std::int64_t s, std::int64_t t) {
      return P{d.x + s * u.x + t * v.x, d.y + s * u.y + t * v.y, d.z + s * u.z + t * v.z};
    };
    P a = in_plane(1, 0), b = in_plane(2, 1), c = in_plane(-1, 2);
    a.x += integer(1);
    const auto determinant = [&] {
      const Int128 ax = a.x - d.x, ay = a.y - d.y, az = a.z - d.z;
      const Int128 bx = b.x - d.x, by = b.y - d.y, bz = b.z - d.z;
      const Int128 cx = c.x - d.x, cy = c.y - d.y, cz = c.z - d.z;
      return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
    };
    const int truth = sign(determinant());
    zeros += truth == 0;
    ASSERT_EQ(orientation(real(a), real(b), real(c), real(d)), truth);
    ASSERT_EQ(orientation(real(b), real(a), real(c), real(d)), -truth);
  }
  EXPECT_GT(zeros, 1000);
}

TEST(Predicates, FlatCaseAgreesWithIntegers) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 20000; ++round) {
    const auto integer = [&] { return static_cast<std::int64_t>(random() % (1ULL << 50)); };
    const std::int64_t px = integer(), py = integer(), qx = integer(), qy = integer();
    // The point is the middle of p and q, off by at most a unit.
    const std::int64_t rx = (px + qx) / 2 + static_cast<std::int64_t>(random() % 3) - 1,
                       ry = (py + qy) / 2;
    const Int128 truth =
        static_cast<Int128>(px - rx) * (qy - ry) - static_cast<Int128>(py - ry) * (qx - rx);
    const auto real = [](std::int64_t x, std::int64_t y) {
      return Vec2{static_cast<double>(x), static_cast<double>(y)};
    };
    ASSERT_EQ(orientation(real(px, py), real(qx, qy), real(rx, ry)), sign(truth));
  }
}

}  // namespace
}  // namespace vpm
