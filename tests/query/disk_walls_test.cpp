// Tests the directions in which tools are pushed behind two walls of points without a camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "libvpm/query/tool_query.h"
#include "libvpm/scene/points/points_body.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

constexpr double kSpacing = 0.002;  // m
constexpr double kSlope = 0.70710678118654752;
constexpr double kDegree = 3.14159265358979323846 / 180;

// Two walls at 45 degrees that meet over the y axis, as a roof or the groove that it would leave.
// The solid is below.
struct TwoWalls {
  bool is_roof;

  Vec3 normal(bool right) const { return {is_roof == right ? kSlope : -kSlope, 0, kSlope}; }
  double height(double x) const { return is_roof ? -std::fabs(x) : std::fabs(x); }
  bool is_solid(Vec3 p) const { return p.z < height(p.x); }
  // Returns the gradient of the distance, behind the surface.
  Vec3 gradient(Vec3 p) const {
    if (is_roof || -p.z < std::fabs(p.x)) return normal(p.x > 0);
    return normalized_or_zero(-1.0 * Vec3{p.x, 0, p.z});  // towards their common edge
  }
  // Each point has the normal of its own wall.
  Cloud seen() const {
    constexpr int kHalf = 60;
    Cloud cloud;
    for (int i = -kHalf; i <= kHalf; ++i) {
      for (int k = -kHalf; k <= kHalf; ++k) {
        const double x = kSpacing * (i + 0.3), y = kSpacing * k;
        cloud.positions.push_back(narrow(Vec3{x, y, height(x)}));
        cloud.normals.push_back(narrow(normal(x > 0)));
        cloud.radii.push_back(static_cast<float>(kSpacing));
      }
    }
    return cloud;
  }
};

double angle(Vec3 a, Vec3 b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

TEST(TwoWallsOfPoints, TheOtherOneIsFoundWhereABodyReachesIt) {
  const TwoWalls roof{true};
  const PointsBody cloud(roof.seen());
  const DiskSurface disks = cloud.surface();
  for (const double x : {-0.006, -0.001, 0.002, 0.007}) {
    const Vec3 at{x, 0.0007, -0.03};
    const SurfaceSample on_surface = disks.sample(at - cloud.to_world().translation);
    const auto finds = [&](double radius, OtherWall& other) {
      return disks.find_other_wall(at - cloud.to_world().translation,
                                   {on_surface.normal, on_surface.foot}, on_surface.point, radius,
                                   kTwoWalls, other);
    };
    OtherWall other;
    ASSERT_TRUE(finds(1.5 * std::fabs(x), other)) << x;
    EXPECT_NEAR(norm(other.normal - roof.normal(x < 0)), 0, 1e-5);
    EXPECT_NEAR(other.border.distance(at - cloud.to_world().translation), std::fabs(x), 1e-5);
    EXPECT_NEAR(std::fabs(other.border.normal.x), 1, 1e-5);
    EXPECT_FALSE(finds(0.9 * std::fabs(x), other));
  }
}

// The riser of a step ends at the floor. Further down its foot is nearest, in another direction,
// which says nothing about the border in a body above that.
TEST(TwoWallsOfPoints, TheBorderIsThatOfTheWallNotOfItsEnd) {
  constexpr double kHeight = 0.05;
  constexpr int kHalf = 60;
  Cloud seen;
  const auto add = [&](Vec3 place, Vec3 normal) {
    seen.positions.push_back(narrow(place));
    seen.normals.push_back(narrow(normal));
    seen.radii.push_back(static_cast<float>(kSpacing));
  };
  for (int k = -kHalf; k <= kHalf; ++k) {
    for (double along = 0.5 * kSpacing; along < 0.12; along += kSpacing) {
      add({-along, kSpacing * k, 0}, {0, 0, 1});
      add({along, kSpacing * k, -kHeight}, {0, 0, 1});
      if (along < kHeight) add({0, kSpacing * k, -along}, {1, 0, 0});
    }
  }
  const PointsBody cloud(seen);
  const DiskSurface disks = cloud.surface();
  for (const double depth : {0.037, 0.041, 0.045}) {  // below the top, whose edge is nearer
    const Vec3 at = Vec3{-depth - 0.002, 0.0007, -depth} - cloud.to_world().translation;
    const SurfaceSample on_surface = disks.sample(at);
    OtherWall other;
    ASSERT_TRUE(disks.find_other_wall(at, {on_surface.normal, on_surface.foot}, on_surface.point,
                                      0.02, kTwoWalls, other));
    EXPECT_NEAR(other.border.distance(at), 0.002 * kSlope, 2e-4) << depth;
    EXPECT_LT(angle(other.normal, {1, 0, 0}), 2 * kDegree) << depth;
  }
}

TEST(TwoWallsOfPoints, OneWallHasNoOther) {
  for (const double bulge : {0.0, 3.0, -3.0}) {  // 1/m: flat, a bowl and a hill
    Cloud seen = TwoWalls{true}.seen();
    for (std::size_t i = 0; i < seen.size(); ++i) {
      Vec3f& p = seen.positions[i];
      const double x = widen(p).x, y = widen(p).y;
      p.z = static_cast<float>(bulge * (x * x + y * y));
      seen.normals[i] = narrow(normalized_or_zero(Vec3{-2 * bulge * x, -2 * bulge * y, 1}));
    }
    const PointsBody cloud(seen);
    const DiskSurface disks = cloud.surface();
    for (const double depth : {0.005, 0.02, 0.04}) {
      const Vec3 at = Vec3{0.004, -0.011, -depth} - cloud.to_world().translation;
      const SurfaceSample on_surface = disks.sample(at);
      OtherWall other;
      EXPECT_FALSE(disks.find_other_wall(at, {on_surface.normal, on_surface.foot}, on_surface.point,
                                         0.02, kTwoWalls, other));
    }
  }
}

// Cones of whole nodes, where they suffice, tell which disks face one way.
TEST(TwoWallsOfPoints, ConesSayWhatEachDiskSays) {
  for (const bool is_roof : {true, false}) {
    const PointsBody cloud(TwoWalls{is_roof}.seen());
    const DiskSurface disks = cloud.surface();
    std::mt19937 random(4);
    std::uniform_real_distribution<double> at(-1, 1);
    int one_way = 0, several = 0;
    for (int k = 0; k < 400; ++k) {
      const Vec3 center =
          0.12 * Vec3{at(random), at(random), 0.3 * at(random)} - cloud.to_world().translation;
      const double radius = 0.03 * std::fabs(at(random));
      const auto toward = static_cast<std::uint32_t>(random() % disks.feet.count);
      const Vec3 n = widen(disks.normals[toward]);
      bool all = true;
      for (std::uint32_t i = 0; i < disks.feet.count; ++i) {
        if (squared_norm(widen(disks.feet.points[i]) - center) > radius * radius) continue;
        disks.for_normals_of(i, [&](Vec3 normal) { all &= dot(normal, n) > kTwoWalls; });
      }
      ASSERT_EQ(disks.face_one_way(center, radius, n, kTwoWalls), all);
      (all ? one_way : several) += 1;
    }
    EXPECT_GT(std::min(one_way, several), 30);
  }
}

// Cones in the nodes of a bowl leave no normal out, and none is much wider than its normals.
TEST(NormalCones, HoldTheNormalsOfTheirNodes) {
  Cloud seen = TwoWalls{true}.seen();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Vec3 p = widen(seen.positions[i]);
    seen.positions[i].z = static_cast<float>(3 * (p.x * p.x + p.y * p.y));
    seen.normals[i] = narrow(normalized_or_zero(Vec3{-6 * p.x, -6 * p.y, 1}));
  }
  const PointsBody cloud(seen);
  const DiskSurface disks = cloud.surface();
  const PointTree& tree = disks.feet;
  int held = 0, within = 0;
  for (std::uint32_t nodes = tree.leaves, size = PointTree::kLeafSize; nodes > 0;
       nodes /= 4, size *= 4) {
    for (std::uint32_t k = 0; k * size < tree.count; ++k) {
      for (const double degrees : {0.0, 5.0, 20.0, 40.0, 80.0}) {
        const Vec3 n{std::sin(kDegree * degrees), 0, std::cos(kDegree * degrees)};
        double least = 1;
        for (std::uint32_t i = k * size; i < std::min((k + 1) * size, tree.count); ++i)
          least = std::min(least, dot(widen(disks.normals[i]), n));
        for (const double cosine : {kTwoWalls, kOneDirection}) {
          const bool says = disks.cones.are_within(nodes + k, n, cosine);
          ASSERT_TRUE(!says || least > cosine) << nodes << ' ' << k;
          held += least > cosine ? 1 : 0;
          within += says ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(within, 0.9 * held);
  EXPECT_GT(held, 1000);
}

// Samples from a list of near disks equal those from all disks.
TEST(TwoWallsOfPoints, AreTheSameAmongTheDisksNearABlock) {
  const PointsBody cloud(TwoWalls{true}.seen());
  const DiskSurface disks = cloud.surface();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(-1, 1);
  int found = 0;
  for (int k = 0; k < 200; ++k) {
    const Vec3 middle =
        Vec3{0.01 * at(random), 0.1 * at(random), -0.02} - cloud.to_world().translation;
    const DiskSurface::AroundBall near =
        disks.around_ball(middle, 0.008, disks.sample(middle).point);
    const Vec3 x = middle + 0.004 * Vec3{at(random), at(random), at(random)};
    const SurfaceSample on_surface = near.sample(x, kNoPoint), direct = disks.sample(x);
    ASSERT_EQ(on_surface.point, direct.point);
    const TangentPlane own{disks.closest_normal(x, direct), direct.foot};
    OtherWall one, other;
    const bool is_met = near.find_other_wall(x, own, direct.point, 0.006, kTwoWalls, one);
    ASSERT_EQ(is_met, disks.find_other_wall(x, own, direct.point, 0.006, kTwoWalls, other));
    if (!is_met) continue;
    ++found;
    EXPECT_EQ(norm(one.normal - other.normal) + norm(one.border.foot - other.border.foot), 0);
  }
  EXPECT_GT(found, 50);
}

// A disk seen at a grazing angle may be wide. It changes nothing far from it.
TEST(DisksOfSeveralSizes, AWideOneIsFeltWhereItIs) {
  Cloud seen = TwoWalls{false}.seen();
  const PointsBody alone(seen);
  seen.positions.push_back({3, 0, 0});
  seen.normals.push_back({0, 0, 1});
  seen.radii.push_back(0.2f);
  const PointsBody with_wide(seen);
  const ToolModel cube = testing::lattice_cube(0.06, 3, 4);
  ToolQuery query(cube, {});
  for (int k = 0; k < 40; ++k) {
    const double half = 0.2 * k, sine = std::sin(half);
    const Pose pose{rotation_from_quaternion({0.6 * sine, 0, 0.8 * sine, std::cos(half)}),
                    {0.002 * (k - 20), 0.001, 0.01}};
    const Result expected = query.run(alone, pose), result = query.run(with_wide, pose);
    EXPECT_GT(expected.volume, 0);
    EXPECT_EQ(result.volume, expected.volume);
    EXPECT_EQ(norm(result.wrench.force - expected.wrench.force), 0);
    EXPECT_EQ(norm(result.wrench.torque - expected.wrench.torque), 0);
  }
}

// The nearest point lies beside the crease. Its disk alone would lead past the crease by up to the
// width of disks.
TEST(TwoWallsOfPoints, BelowAGrooveTheCreaseIsNearest) {
  const TwoWalls groove{false};
  const PointsBody cloud(groove.seen());
  const DiskSurface disks = cloud.surface();
  for (const double depth : {0.01, 0.03, 0.06}) {
    for (const double aside : {-1.6, -0.9, -0.4, 0.0, 0.2, 0.7, 1.3}) {
      const Vec3 at{aside * depth, 0.0007, -depth};
      const Vec3 there = at - cloud.to_world().translation;
      const Vec3 direction = disks.closest_normal(there, disks.sample(there));
      EXPECT_LT(angle(direction, groove.gradient(at)), 0.5 * kDegree) << depth << ' ' << aside;
    }
  }
}

// Computes force and torque on a cube, relative to its volume, by midpoints.
Wrench true_force(const TwoWalls& walls, double edge, const Pose& pose) {
  constexpr int kPlaces = 90;
  Wrench sum;
  for (int i = 0; i < kPlaces * kPlaces * kPlaces; ++i) {
    const auto along = [&](int k) { return edge * ((k + 0.5) / kPlaces - 0.5); };
    const Vec3 arm = pose.rotation * Vec3{along(i % kPlaces), along(i / kPlaces % kPlaces),
                                          along(i / (kPlaces * kPlaces))};
    const Vec3 at = pose.translation + arm;
    if (!walls.is_solid(at)) continue;
    const Vec3 normal = walls.gradient(at);
    sum.force += normal;
    sum.torque += cross(arm, normal);
  }
  constexpr double kCount = 1.0 * kPlaces * kPlaces * kPlaces;
  return {sum.force / kCount, sum.torque / kCount};
}

// A piece below the edge of a roof is cut by both walls, and neither has it alone.
TEST(TwoWallsOfPoints, WhatTheyCutIsSharedOutToo) {
  constexpr double kToolSide = 0.012;
  const TwoWalls roof{true};
  const PointsBody cloud(roof.seen());
  const ToolModel piece = testing::lattice_cube(kToolSide, 1, 1);
  ToolQuery query(piece, {});
  for (const double x : {-0.001, 0.0, 0.0015}) {
    const Pose pose{{}, {x, 0.0013, -0.004}};
    const Vec3 force = query.run(cloud, pose).wrench.force;
    EXPECT_LT(angle(force, true_force(roof, kToolSide, pose).force), 9 * kDegree) << x;
  }
}

// Most of the cube's 27 cells reach both walls. Pushed whole to the nearest one, the force's
// direction would err by up to 10 degrees.
TEST(TwoWallsOfPoints, AToolIsSharedOutBetweenThem) {
  constexpr double kToolSide = 0.06;
  const ToolModel cube = testing::lattice_cube(kToolSide, 3, 4);
  ToolQuery query(cube, {});
  for (const bool is_roof : {true, false}) {
    const TwoWalls walls{is_roof};
    const PointsBody cloud(walls.seen());
    for (const double x : {-0.013, -0.006, 0.004, 0.011}) {
      for (const double z : {-0.012, -0.021}) {
        const Pose pose{{}, {x, 0.0013, is_roof ? z : z + 0.02}};
        const Wrench truth = true_force(walls, kToolSide, pose);
        const Result result = query.run(cloud, pose);
        const Vec3 force = 1 / cube.volume * result.wrench.force,
                   torque = 1 / cube.volume * result.wrench.torque;
        const double volume = result.volume / cube.volume;
        EXPECT_LT(angle(force, truth.force), 1.2 * kDegree) << is_roof << ' ' << x << ' ' << z;
        EXPECT_NEAR(norm(force), norm(truth.force), 0.03 * volume);
        EXPECT_NEAR(norm(torque - truth.torque), 0, 0.01 * volume * cube.radius) << is_roof;
      }
    }
  }
}

}  // namespace
}  // namespace vpm
