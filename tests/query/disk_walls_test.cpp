// Points alone that show two walls: where tools behind both are pushed.
#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/query/prepared_cloud.h"
#include "libvpm/query/query.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

constexpr double kSpacing = 0.002;  // m
constexpr double kSlope = 0.70710678118654752;
constexpr double kDegree = 3.14159265358979323846 / 180;

// Two walls at 45 degrees that meet over the y axis: a roof, or the groove that it would leave. The
// solid is below.
struct TwoWalls {
  bool is_roof;

  Vec3 normal(bool right) const { return {is_roof == right ? kSlope : -kSlope, 0, kSlope}; }
  double height(double x) const { return is_roof ? -std::fabs(x) : std::fabs(x); }
  bool is_solid(Vec3 p) const { return p.z < height(p.x); }
  // Gradient of the distance, behind the surface.
  Vec3 gradient(Vec3 p) const {
    if (is_roof || -p.z < std::fabs(p.x)) return normal(p.x > 0);
    return normalized_or_zero(-1.0 * Vec3{p.x, 0, p.z});  // to where they meet
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
  const PreparedCloud cloud(roof.seen());
  const DiskSurface disks = cloud.disk_surface();
  for (const double x : {-0.006, -0.001, 0.002, 0.007}) {
    const Vec3 at{x, 0.0007, -0.03};
    const Reading reading = disks.read(at - cloud.origin());
    const auto finds = [&](double radius, OtherWall& other) {
      return disks.find_other_wall(at - cloud.origin(), {reading.normal, reading.foot},
                                   reading.point, radius, kTwoWalls, other);
    };
    OtherWall other;
    ASSERT_TRUE(finds(1.5 * std::fabs(x), other)) << x;
    EXPECT_NEAR(norm(other.normal - roof.normal(x < 0)), 0, 1e-5);
    EXPECT_NEAR(other.border.distance(at - cloud.origin()), std::fabs(x), 1e-5);
    EXPECT_NEAR(std::fabs(other.border.normal.x), 1, 1e-5);
    EXPECT_FALSE(finds(0.9 * std::fabs(x), other));
  }
}

TEST(TwoWallsOfPoints, OneWallHasNoOther) {
  for (const double bulge : {0.0, 3.0, -3.0}) {  // 1/m: flat, and a bowl and a hill
    Cloud seen = TwoWalls{true}.seen();
    for (std::size_t i = 0; i < seen.size(); ++i) {
      Vec3f& p = seen.positions[i];
      const double x = widen(p).x, y = widen(p).y;
      p.z = static_cast<float>(bulge * (x * x + y * y));
      seen.normals[i] = narrow(normalized_or_zero(Vec3{-2 * bulge * x, -2 * bulge * y, 1}));
    }
    const PreparedCloud cloud(seen);
    const DiskSurface disks = cloud.disk_surface();
    for (const double depth : {0.005, 0.02, 0.04}) {
      const Vec3 at = Vec3{0.004, -0.011, -depth} - cloud.origin();
      const Reading reading = disks.read(at);
      OtherWall other;
      EXPECT_FALSE(disks.find_other_wall(at, {reading.normal, reading.foot}, reading.point, 0.02,
                                         kTwoWalls, other));
    }
  }
}

// The nearest point is one beside the crease. Its disk alone would lead past the crease by as much
// as disks may be wide.
TEST(TwoWallsOfPoints, BelowAGrooveTheCreaseIsNearest) {
  const TwoWalls groove{false};
  const PreparedCloud cloud(groove.seen());
  const DiskSurface disks = cloud.disk_surface();
  for (const double depth : {0.01, 0.03, 0.06}) {
    for (const double aside : {-1.6, -0.9, -0.4, 0.0, 0.2, 0.7, 1.3}) {
      const Vec3 at{aside * depth, 0.0007, -depth};
      const Vec3 there = at - cloud.origin();
      const Vec3 direction = disks.closest_normal(there, disks.read(there));
      EXPECT_LT(angle(direction, groove.gradient(at)), 0.5 * kDegree) << depth << ' ' << aside;
    }
  }
}

// Force and torque on a cube, in parts of its volume, by midpoints.
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

// A cube of 27 shares, of which most reach both walls: pushed whole to the nearest one, the force's
// direction would err by up to 10 degrees.
TEST(TwoWallsOfPoints, AToolIsSharedOutBetweenThem) {
  constexpr double kEdge = 0.06;
  const ToolModel cube = testing::lattice_cube(kEdge, 3, 4);
  Query query(cube, {});
  for (const bool is_roof : {true, false}) {
    const TwoWalls walls{is_roof};
    const PreparedCloud cloud(walls.seen());
    for (const double x : {-0.013, -0.006, 0.004, 0.011}) {
      for (const double z : {-0.012, -0.021}) {
        const Pose pose{{}, {x, 0.0013, is_roof ? z : z + 0.02}};
        const Wrench truth = true_force(walls, kEdge, pose);
        const Result result = query.run(cloud, pose);
        const Vec3 force = 1 / cube.volume * result.wrench.force,
                   torque = 1 / cube.volume * result.wrench.torque;
        const double volume = result.volume / cube.volume;
        EXPECT_LT(angle(force, truth.force), 1.2 * kDegree) << is_roof << ' ' << x << ' ' << z;
        EXPECT_NEAR(norm(force), norm(truth.force), 0.03 * volume);
        EXPECT_NEAR(norm(torque - truth.torque), 0, 0.01 * volume * cube.reach) << is_roof;
      }
    }
  }
}

}  // namespace
}  // namespace vpm
