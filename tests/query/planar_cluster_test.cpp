// Tests planar clusters before a camera.
#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/measure/classify.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/depth/depth_body.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::see;

constexpr double kClusterReach = 0.015;  // radius of the clusters, m

// Finds the plane of a cluster about a place of the scene, in camera coordinates. Returns false if
// it is not planar.
bool plane_at(const DepthBody& cloud, Vec3 center, TangentPlane& plane) {
  const DepthSurface surface = cloud.surface();
  return finds_cluster_plane(surface, surface.classify_ball(center, kClusterReach), center,
                             kClusterReach, HUGE_VAL, SampleInTurn{}, plane);
}

// Returns the mean height of the plane over the surface, at places of a box in the cluster's ball.
double mean_height(const TangentPlane& plane, const synthetic::Surface& surface, Vec3 center) {
  constexpr int kPlaces = 5;
  const double half = kClusterReach / std::sqrt(3.0);
  double sum = 0;
  for (int k = 0; k < kPlaces * kPlaces * kPlaces; ++k) {
    const auto along = [&](int place) { return half * ((place + 0.5) / kPlaces * 2 - 1); };
    const Vec3 x = center + Vec3{along(k % kPlaces), along(k / kPlaces % kPlaces),
                                 along(k / kPlaces / kPlaces)};
    sum += surface.distance(x) - plane.distance(x);
  }
  return sum / (kPlaces * kPlaces * kPlaces);
}

class PatchOnABall : public ::testing::TestWithParam<const char*> {};

TEST_P(PatchOnABall, IsAsHighAsTheSurfaceInTheMean) {
  const synthetic::Scene scene = synthetic::make_scene(GetParam());
  const DepthBody cloud(see(scene));
  // Bounds the mean height of a tangent plane.
  constexpr double kSmallestRadius = 0.25, kLargestRadius = 0.3;
  const double sagitta = kClusterReach * kClusterReach / (9 * kLargestRadius);
  int seen = 0;
  for (const double u : {-0.08, -0.03, 0.0, 0.05}) {
    for (const double deep : {-0.005, 0.0, 0.005}) {
      Vec3 center{u, 0.02, 1};
      center -= (scene.surface->distance(center) + deep) * scene.surface->gradient(center);
      TangentPlane plane;
      if (!plane_at(cloud, center, plane)) continue;
      ++seen;
      EXPECT_LE(std::abs(mean_height(plane, *scene.surface, center)), 0.35 * sagitta)
          << "at " << center.x << ", " << deep << " m deep";
      const double tilt = norm(plane.normal - scene.surface->gradient(plane.foot));
      EXPECT_LE(tilt, 0.1 * kClusterReach / kSmallestRadius);
    }
  }
  EXPECT_EQ(seen, 12);
}

INSTANTIATE_TEST_SUITE_P(Balls, PatchOnABall, ::testing::Values("ball", "inverted-ball"),
                         [](const auto& variant) {
                           return std::string(variant.param == std::string("ball") ? "Outside"
                                                                                   : "Inside");
                         });

TEST(Patch, NoneWhereSeveralSurfacesMeet) {
  TangentPlane plane;
  const DepthBody step(see(synthetic::make_scene("step")));
  EXPECT_TRUE(plane_at(step, {0.05, 0, 1}, plane));
  EXPECT_FALSE(plane_at(step, {-0.03, 0, 1}, plane)) << "half wall, half step";
  const DepthBody groove(see(synthetic::make_scene("groove")));
  EXPECT_TRUE(plane_at(groove, {0.05, 0, 0.95}, plane));
  EXPECT_FALSE(plane_at(groove, {0, 0, 0.997}, plane)) << "the bottom, where both walls are seen";
}

TEST(Patch, NoneWhereTheImageHasAHole) {
  const synthetic::Scene scene = synthetic::make_scene("wall");
  const Vec3 middle{0.05, 0.03, 1};
  Cloud cloud = see(scene);
  TangentPlane plane;
  EXPECT_TRUE(plane_at(DepthBody(cloud), middle, plane));
  DepthImage& depth = cloud.sensor->depth;
  const auto u = static_cast<std::uint32_t>(scene.camera.intrinsics.fx * middle.x +
                                            scene.camera.intrinsics.cx);
  const auto v = static_cast<std::uint32_t>(scene.camera.intrinsics.fy * middle.y +
                                            scene.camera.intrinsics.cy);
  for (std::uint32_t row = v - 3; row <= v + 3; ++row) {
    for (std::uint32_t column = u - 3; column <= u + 3; ++column)
      depth.depth[row * depth.width + column] = 0;
  }
  EXPECT_FALSE(plane_at(DepthBody(cloud), middle, plane));
}

// True if every pixel that a ball may cover shows a surface behind all of it.
bool is_seen_free(const DepthImage& depth, const Intrinsics& k, Vec3 center, double radius) {
  const double nearest = center.z - radius, farthest = center.z + radius;
  const auto first = [&](double f, double x, double c) {
    return static_cast<int>(std::floor(f * (x - radius) / (x < radius ? nearest : farthest) + c));
  };
  const auto last = [&](double f, double x, double c) {
    return static_cast<int>(std::ceil(f * (x + radius) / (x > -radius ? nearest : farthest) + c));
  };
  for (int v = first(k.fy, center.y, k.cy); v <= last(k.fy, center.y, k.cy); ++v) {
    for (int u = first(k.fx, center.x, k.cx); u <= last(k.fx, center.x, k.cx); ++u) {
      const float seen =
          depth.depth[depth.index(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v))];
      if (!(static_cast<double>(seen) > farthest)) return false;
    }
  }
  return true;
}

// Small pits in a wall leave planar clusters unchanged, and are wider than cells.
TEST(Patch, CellsThatAreSeenFreeDoNotCount) {
  constexpr std::uint32_t kPit = 14, kEvery = 40;  // pixels
  constexpr float kDeep = 0.016F;
  const synthetic::Scene scene = synthetic::make_scene("wall");
  Cloud seen = see(scene);
  DepthImage& depth = seen.sensor->depth;
  for (std::uint32_t v = 0; v < depth.height; ++v) {
    for (std::uint32_t u = 0; u < depth.width; ++u)
      if (u % kEvery < kPit && v % kEvery < kPit) depth.depth[v * depth.width + u] += kDeep;
  }
  const DepthBody cloud(seen);
  const ToolModel tool = testing::lattice_cube(0.2, 24, 2);
  ToolQuery query(tool, {});
  int free = 0;
  for (int k = 0; k < 20; ++k) {
    const Pose pose{testing::generic_rotation(), {0.003 * k, 0.002 * k, 0.88 + 0.001 * k}};
    query.run(cloud, pose);
    for (std::size_t i = 0; i < tool.spheres.size(); ++i) {
      // Adds a tenth, since the rounding of pixels is not tested here.
      const double radius = 1.1 * tool.levels[0].cell_radius[i];
      const Vec3 center = pose * tool.spheres[i].center;
      if (!is_seen_free(depth, scene.camera.intrinsics, center, radius)) continue;
      if (center.z < 1) continue;  // free in front of the wall too
      ++free;
      EXPECT_EQ(query.states()[i], SphereState::outside) << "pose " << k << ", sphere " << i;
    }
  }
  EXPECT_GT(free, 20) << "no share was in a pit";
}

}  // namespace
}  // namespace vpm
