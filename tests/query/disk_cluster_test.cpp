// Tests planar clusters of points without a camera.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "libvpm/measure/classify.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/points/points_body.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

constexpr double kClusterRadius = 0.02;  // radius of the clusters, m
constexpr double kPointSpacing = 0.002;

class Noise {
 public:
  double next(double deviation) { return deviation * normal_(random_); }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

struct Height {
  double height = 0;
  Vec3 normal{0, 0, 1};
};
// Adds points over a square of the xy plane.
void add_points(const std::function<Height(double x, double y)>& at, Cloud& cloud) {
  constexpr int kHalf = 30;
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int k = -kHalf; k <= kHalf; ++k) {
      const double x = kPointSpacing * i, y = kPointSpacing * k;
      const Height h = at(x, y);
      cloud.positions.push_back(narrow(Vec3{x, y, h.height}));
      cloud.normals.push_back(narrow(normalized_or_zero(h.normal)));
      cloud.radii.push_back(static_cast<float>(kPointSpacing));
    }
  }
}

// Returns a wall with noise; `height` and `slope` are deviations of the height, m, and of the
// normal's slopes.
Cloud noisy_wall(double height, double slope) {
  Noise noise;
  Cloud cloud;
  add_points(
      [&](double, double) {
        const double z = noise.next(height), x = noise.next(slope), y = noise.next(slope);
        return Height{z, {x, y, 1}};
      },
      cloud);
  return cloud;
}

bool sees_plane(const Cloud& cloud, Vec3 center, TangentPlane& plane) {
  const PointsBody prepared(cloud);
  const DiskSurface disks = prepared.surface();
  return finds_cluster_plane(disks, disks.classify_ball(center, kClusterRadius), center,
                             kClusterRadius, HUGE_VAL, SampleInTurn{}, plane);
}

TEST(PatchOfPoints, NoiseIsAveraged) {
  const Cloud cloud = noisy_wall(0.002, 0.15);
  for (const double height : {0.01, 0.0, -0.015}) {
    TangentPlane plane;
    ASSERT_TRUE(sees_plane(cloud, {0.001, -0.002, height}, plane)) << height;
    EXPECT_NEAR(plane.distance({}), 0, 0.0006);  // 3 standard deviations of the mean of 130
    EXPECT_GT(plane.normal.z, std::cos(0.06));
  }
}

TEST(PatchOfPoints, IsAsHighAsACurvedSurfaceInTheMean) {
  constexpr double kRadius = 0.25;
  Cloud cloud;
  add_points(
      [](double x, double y) {
        const double z = std::sqrt(kRadius * kRadius - x * x - y * y);
        return Height{z - kRadius, {x, y, z}};
      },
      cloud);
  TangentPlane plane;
  ASSERT_TRUE(sees_plane(cloud, {}, plane));
  // This is the mean of the sagitta (x^2 + y^2) / 2r over a cube in the ball.
  const double sagitta = kClusterRadius * kClusterRadius / (9 * kRadius);
  EXPECT_NEAR(plane.foot.z, -sagitta, 0.1 * sagitta);
}

TEST(PatchOfPoints, ThereIsNoneWhereTheSurfaceIsNotOne) {
  const auto flat = [](double height, double up) {
    return [=](double, double) { return Height{height, {0, 0, up}}; };
  };
  TangentPlane plane;
  Cloud plate;
  add_points(flat(0.002, 1), plate);
  add_points(flat(-0.002, -1), plate);
  EXPECT_FALSE(sees_plane(plate, {}, plane));

  Cloud step;
  add_points([](double x, double) { return Height{x < 0 ? 0.0 : -0.04}; }, step);
  EXPECT_FALSE(sees_plane(step, {}, plane));
  EXPECT_TRUE(sees_plane(step, {-0.03, 0, 0}, plane));

  Cloud crease;
  add_points(
      [](double x, double) {
        return Height{-std::abs(x), {x < 0 ? -1.0 : 1.0, 0, 1}};
      },
      crease);
  EXPECT_FALSE(sees_plane(crease, {}, plane));
  EXPECT_TRUE(sees_plane(crease, {-0.03, 0, -0.03}, plane));
}

TEST(PatchOfPoints, ThereIsNoneBeyondTheRim) {
  Cloud cloud;
  add_points([](double, double) { return Height{}; }, cloud);
  TangentPlane plane;
  EXPECT_TRUE(sees_plane(cloud, {0.03, 0, 0}, plane));
  EXPECT_FALSE(sees_plane(cloud, {0.065, 0, 0}, plane));
}

// Everything behind the wall is pushed, nothing in front of it, and the cut cells by the mean
// plane.
TEST(PatchOfPoints, CountsWhatIsBehindANoisyWall) {
  constexpr double kToolSide = 0.08;
  const PointsBody prepared(noisy_wall(0.001, 0.1));
  const ToolModel tool = testing::lattice_cube(kToolSide, 24, 2);
  ToolQuery query(tool, {});
  for (const double depth : {0.01, 0.02, 0.04}) {
    const Result result = query.run(prepared, {{}, {0.001, 0.002, kToolSide / 2 - depth}});
    EXPECT_NEAR(result.volume_fraction, depth / kToolSide, 0.001) << depth;
    const Vec3 push = normalized_or_zero(result.wrench.force);
    EXPECT_GT(push.z, std::cos(0.02)) << depth;
  }
}

}  // namespace
}  // namespace vpm
