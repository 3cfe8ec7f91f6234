#include "libvpm/query/scene_scale.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

constexpr double kToolReach = 0.17;
constexpr double kPixel = 1.0 / 525;  // metres at 1 m

SceneScale scale_of(const char* scene) {
  return scene_scale(AnyBody(testing::see(synthetic::make_scene(scene))), kToolReach,
                     Vec3{0, 0, 1});
}

TEST(SceneScale, OfAWallIsItsPixels) {
  const SceneScale scale = scale_of("wall");
  EXPECT_NEAR(scale.spacing, kPixel, 0.1 * kPixel);
  EXPECT_LT(scale.noise, 1e-6);
  EXPECT_LT(scale.curvature, 0.01);
  EXPECT_NEAR(scale.smallest_radius(), kPixel / std::sqrt(2.0), 0.1 * kPixel);
  EXPECT_GT(scale.largest_radius(), kToolReach / 2);
}

TEST(SceneScale, TellsTheRadiusOfABall) {
  for (const auto& [scene, radius] : {std::pair("ball", 0.25), std::pair("inverted-ball", 0.3)}) {
    const SceneScale scale = scale_of(scene);
    EXPECT_NEAR(scale.curvature * radius, 1, 0.1) << scene;
    EXPECT_LT(scale.noise, 1e-5);
    // The surface leaves the plane by as much as the points resolve.
    const double largest = scale.largest_radius();
    EXPECT_NEAR(largest * largest / (2 * radius), scale.smallest_radius(),
                0.12 * scale.smallest_radius());
  }
}

TEST(SceneScale, TellsTheNoiseOfTheSensor) {
  const synthetic::Scene scene = synthetic::make_scene("wall");
  Cloud cloud = without_camera(testing::see(scene));
  // Uniform noise in [-a, a] along the ray has the standard deviation a / sqrt(3).
  const double amplitude = 0.004;
  std::uint64_t state = 1;
  for (Vec3f& p : cloud.positions) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    const double u = static_cast<double>(state >> 11) * 0x1p-53;
    p.z += static_cast<float>(amplitude * (2 * u - 1));
  }
  const SceneScale scale = scene_scale(AnyBody(cloud), kToolReach, Vec3{0, 0, 1});
  EXPECT_NEAR(scale.noise, amplitude / std::sqrt(3.0), 0.15 * amplitude);
  EXPECT_NEAR(scale.smallest_radius(), 2 * scale.noise, 1e-12);
}

TEST(SceneScale, LooksNearTheToolOnly) {
  // A plate stands half a metre in front of a wall; its points are closer to each other.
  const AnyBody cloud(testing::see(synthetic::make_scene("plate")));
  EXPECT_NEAR(scene_scale(cloud, kToolReach, Vec3{0, 0, 1}).spacing, kPixel, 0.1 * kPixel);
  EXPECT_GT(scene_scale(cloud, kToolReach, std::nullopt).spacing, 1.3 * kPixel);
}

TEST(SceneScale, SameBitsForAnyOrderAndThreads) {
  const Cloud cloud = testing::see(synthetic::make_scene("groove"));
  const SceneScale once = scene_scale(AnyBody(cloud), kToolReach, std::nullopt);
  set_thread_count(3);
  const SceneScale again =
      scene_scale(AnyBody(testing::permuted(testing::doubled(cloud))), kToolReach, std::nullopt);
  set_thread_count(0);
  EXPECT_EQ(once.spacing, again.spacing);
  EXPECT_EQ(once.noise, again.noise);
  EXPECT_EQ(once.curvature, again.curvature);
}

TEST(SceneScale, RefusesAHandfulOfPoints) {
  Cloud cloud;
  cloud.positions.assign(kFewestPoints - 1, {});
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    cloud.positions[i].x = static_cast<float>(i);
  cloud.normals.assign(cloud.positions.size(), {0, 0, 1});
  cloud.radii.assign(cloud.positions.size(), 1);
  EXPECT_THROW(scene_scale(AnyBody(cloud), kToolReach, std::nullopt), Error);
}

TEST(SceneLevel, StopsAtTheSmallestSphereThatPointsResolve) {
  ToolModel tool = testing::lattice_cube(0.2, 2, 2);
  const Level level = tool.levels.front();
  tool.levels.assign(3, level);
  tool.spheres.clear();
  for (const double radius : {0.05, 0.02, 0.01, 0.008, 0.004, 0.001})
    tool.spheres.push_back({{}, radius});
  tool.levels[0].sphere_count = 2;
  tool.levels[1].sphere_count = 4;
  tool.levels[2].sphere_count = 6;
  const auto chosen = [&](double smallest) {
    return level_for_scene(tool, {std::sqrt(2.0) * smallest, 0, 0});
  };
  EXPECT_EQ(chosen(0.0005), 2u);
  EXPECT_EQ(chosen(0.0015), 1u);
  EXPECT_EQ(chosen(0.015), 0u);
  EXPECT_EQ(chosen(0.05), 0u);
  // With a calibration, a level that is not more accurate is not required.
  tool.calibration = {{0.01, 0.02, 0.03}, {0.001, 0.002, 0.003}, {0.0009, 0.002, 0.003}};
  EXPECT_EQ(chosen(0.0005), 1u);
}

// Counts the points that a query reads: those in the ranges that hold all of the tool's ball.
std::size_t looked_at(const Cloud& cloud) {
  std::size_t count = 0;
  const AnyBody prepared(cloud);
  const Vec3 place = Vec3{0, 0, 1} - prepared.origin();
  prepared.visit([&](const auto& body) {
    body.prepared().for_ranges_in_ball(
        place, 0.1, [&](std::uint32_t begin, std::uint32_t end) { count += end - begin; });
  });
  return count;
}

TEST(PointsOutOfReach, AreNotLookedAt) {
  const synthetic::Scene scene = synthetic::make_scene("wall");
  const Cloud all = testing::see(scene);
  Cloud near = all, far = without_camera(all);
  near.positions.clear();
  near.normals.clear();
  near.radii.clear();
  near.pixels.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (norm(all.origin + widen(all.positions[i]) - Vec3{0, 0, 1}) > 0.2) continue;
    near.positions.push_back(all.positions[i]);
    near.normals.push_back(all.normals[i]);
    near.radii.push_back(all.radii[i]);
    near.pixels.push_back(all.pixels[i]);
  }
  ASSERT_GT(all.size(), 2 * near.size());
  EXPECT_EQ(looked_at(all), looked_at(near)) << "seen by a camera";
  near = without_camera(near);
  const std::size_t of_near = looked_at(near);
  EXPECT_LE(static_cast<double>(looked_at(far)), 1.1 * static_cast<double>(of_near))
      << "points alone: leaves at the rim may hold others";
}

}  // namespace
}  // namespace vpm
