#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/scene/any_body.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::see;

TEST(AnyBody, MergesEqualPointsAndForgetsTheirOrder) {
  const Cloud seen = see(synthetic::make_scene("ball"));
  for (const Cloud& cloud : {seen, without_camera(seen)}) {
    const AnyBody plain(cloud), shuffled(testing::permuted(cloud)), twice(testing::doubled(cloud));
    EXPECT_EQ(plain.positions().size(), cloud.size());
    EXPECT_EQ(plain.positions(), shuffled.positions());
    EXPECT_EQ(plain.normals(), twice.normals());
    EXPECT_EQ(plain.positions(), twice.positions());
  }
}

TEST(AnyBody, RangesHoldEveryPointOfABall) {
  const Cloud seen = see(synthetic::make_scene("inverted-ball"));
  for (const Cloud& cloud : {seen, without_camera(seen)}) {
    const AnyBody prepared(cloud);
    for (const Vec3 center :
         {Vec3{0, 0, 0.95}, Vec3{0.1, 0.2, 0.8}, Vec3{-0.3, 0, 0.01}, Vec3{0, 0, -1}}) {
      const double radius = 0.15;
      std::size_t expected = 0, found = 0;
      for (const Vec3f& p : prepared.positions()) expected += norm(widen(p) - center) < radius;
      const auto count = [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t k = begin; k < end; ++k)
          found += norm(widen(prepared.positions()[k]) - center) < radius;
      };
      prepared.visit(
          [&](const auto& body) { body.prepared().for_ranges_in_ball(center, radius, count); });
      EXPECT_EQ(found, expected);
    }
  }
}

// Tiles of the image cover more than a ball does, and the surface beside the ball must not count.
TEST(DepthBody, BallInFrontOfAllThatItsPixelsShowIsFree) {
  const DepthBody prepared(see(synthetic::make_scene("step")));
  const DepthSurface surface = prepared.surface();
  int free = 0, beside_the_step = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 center{-0.03 + 0.02 * std::sin(12.9 * k), 0.2 * std::sin(78.2 * k),
                      0.97 + 0.03 * std::sin(37.7 * k)};
    const double radius = 0.002 + 0.003 * std::abs(std::sin(5.3 * k));
    const DepthSurface::BallClass in_ball = surface.classify_ball(center, radius);
    bool in_front = true;
    for (std::int32_t v = in_ball.pixels.v0; v <= in_ball.pixels.v1; ++v) {
      for (std::int32_t u = in_ball.pixels.u0; u <= in_ball.pixels.u1; ++u)
        in_front &= (center.z + radius) * surface.measured_at(u, v) < 1;
    }
    EXPECT_EQ(surface.side_of(in_ball, center, radius) == Side::free, in_front);
    free += in_front;
    beside_the_step += in_front && in_ball.side == Side::ambiguous;
  }
  EXPECT_GT(free, 1000);
  EXPECT_GT(beside_the_step, 20);  // tiles alone do not decide these
}

TEST(PointsBody, NearestIsTheNearest) {
  Cloud cloud = without_camera(see(synthetic::make_scene("groove")));
  cloud.positions.resize(3001), cloud.normals.resize(3001), cloud.radii.resize(3001);
  const PreparedPoints prepared(cloud);
  const DiskSurface disks = prepared.surface();
  for (int k = 0; k < 200; ++k) {
    const Vec3 x{std::sin(12.9 * k), std::sin(78.2 * k), 1 + std::sin(37.7 * k)};
    double best = HUGE_VAL;
    for (const Vec3f& p : prepared.disks().feet) best = std::min(best, squared_norm(widen(p) - x));
    const std::uint32_t found = disks.feet.nearest(x, HUGE_VAL);
    ASSERT_NE(found, kNoPoint);
    EXPECT_EQ(squared_norm(widen(prepared.disks().feet[found]) - x), best);
    const std::uint32_t begin_at = static_cast<std::uint32_t>(k) * 15;
    EXPECT_EQ(disks.feet.nearest(x, HUGE_VAL, begin_at), found);
  }
}

// The side of a ball must be true of every place in it.
TEST(DepthSurface, SideOfBallIsConservative) {
  for (const char* name : {"wall", "groove", "block", "inverted-ball"}) {
    const DepthBody cloud(see(synthetic::make_scene(name)));
    const DepthSurface surface = cloud.surface();
    int decided = 0;
    for (int k = 0; k < 3000; ++k) {
      const Vec3 center{0.4 * std::sin(12.9 * k), 0.3 * std::sin(78.2 * k),
                        1 + 0.5 * std::sin(37.7 * k)};
      const double radius = 0.002 + 0.05 * std::abs(std::sin(4.1 * k));
      const Side side = surface.side_of(surface.classify_ball(center, radius), center, radius);
      if (side == Side::ambiguous) continue;
      ++decided;
      for (int s = 0; s < 30; ++s) {
        const Vec3 direction =
            normalized_or_zero({std::sin(3.3 * s), std::sin(7.7 * s + 1), std::sin(5.1 * s + 2)});
        const SurfaceSample on_surface = surface.sample(center + radius * direction);
        if (side == Side::behind) {
          EXPECT_TRUE(on_surface.known && on_surface.distance < 0) << name << k;
        } else {
          EXPECT_TRUE(!on_surface.known || on_surface.distance > 0) << name << k;
        }
      }
    }
    EXPECT_GT(decided, 1000) << name;
  }
}

TEST(PointsBody, AroundABallTheNearestPointIsTheSame) {
  // Many distances on a lattice are equal. The spacings make short lists of points and long ones.
  for (const double spacing : {0.001, 0.01, 0.1}) {
    Cloud cloud;
    for (int i = -20; i <= 20; ++i) {
      for (int k = -20; k <= 20; ++k) {
        cloud.positions.push_back(narrow(Vec3{i * spacing, k * spacing, 0.25 * spacing * (k % 2)}));
        cloud.normals.push_back({0, 0, 1});
        cloud.radii.push_back(static_cast<float>(spacing));
      }
    }
    const PreparedPoints prepared(cloud);
    const DiskSurface disks = prepared.surface();
    for (const double height : {0.0, 0.02, -0.3}) {
      for (const double radius : {0.004, 0.02}) {
        const Vec3 center{0.5 * spacing, 0, height};
        const auto around = disks.around_ball(center, radius, disks.feet.nearest(center, HUGE_VAL));
        for (int k = 0; k < 200; ++k) {
          const Vec3 x = center + radius * Vec3{std::sin(k), std::cos(1.7 * k), std::sin(2.3 * k)};
          ASSERT_EQ(around.sample(x, kNoPoint).point, disks.feet.nearest(x, HUGE_VAL)) << spacing;
        }
        ASSERT_EQ(around.sample(center, kNoPoint).point, disks.feet.nearest(center, HUGE_VAL));
      }
    }
  }
}

TEST(DepthBody, RefusesAPointOffItsPixel) {
  Cloud cloud = see(synthetic::make_scene("wall"));
  cloud.positions[5].x += 0.1f;
  EXPECT_THROW(AnyBody{cloud}, Error);
}

TEST(DepthBody, RefusesTwoPointsAtOnePixel) {
  Cloud cloud = testing::doubled(see(synthetic::make_scene("wall")));
  cloud.positions[5].z *= 1.001f;
  EXPECT_THROW(AnyBody{cloud}, Error);
}

TEST(PointsBody, EmptyCloudsAnswerNothing) {
  const PointsBody cloud{Cloud{}};
  EXPECT_EQ(cloud.surface().feet.nearest({}, HUGE_VAL), kNoPoint);
}

}  // namespace
}  // namespace vpm
