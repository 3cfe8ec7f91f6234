#include "libvpm/synthetic/surface.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libvpm/core/error.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "tests/refusal.h"
#include "tests/test_name.h"

namespace vpm::synthetic {
namespace {

Vec3 random_point(NormalNumbers& numbers) {
  return Vec3{0, 0, 1} + 0.2 * Vec3{numbers.next(), numbers.next(), numbers.next()};
}

class SceneTest : public testing::TestWithParam<std::string> {};

TEST_P(SceneTest, GradientIsThatOfTheDistance) {
  const SurfacePtr surface = make_scene(GetParam()).surface;
  NormalNumbers numbers(1, 0);
  constexpr double kStep = 1e-6;
  int smooth = 0;
  for (int k = 0; k < 1000; ++k) {
    const Vec3 p = random_point(numbers), g = surface->gradient(p);
    EXPECT_NEAR(norm(g), 1, 1e-12);
    // The distance grows at rate 1 along its gradient, except right at a ridge.
    const double rate =
        (surface->distance(p + kStep * g) - surface->distance(p - kStep * g)) / (2 * kStep);
    smooth += std::abs(rate - 1) < 1e-6;
  }
  EXPECT_GE(smooth, 995);
}

TEST_P(SceneTest, NearestPointLiesOnTheSurface) {
  const SurfacePtr surface = make_scene(GetParam()).surface;
  NormalNumbers numbers(2, 0);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 p = random_point(numbers);
    EXPECT_NEAR(surface->distance(p - surface->distance(p) * surface->gradient(p)), 0, 1e-12);
  }
}

// Sensor noise reads the gradient at places on the surface, within rounding.
TEST_P(SceneTest, GradientOnTheSurfaceIsThatJustBeforeIt) {
  const Scene scene = make_scene(GetParam());
  RayCaster rays(*scene.surface, scene.camera);
  int alike = 0, seen = 0;
  for (int k = 0; k < 400; ++k) {
    const double u = 12.3 + 30.7 * (k % 20), v = 11.1 + 22.9 * (k / 20);
    const std::optional<double> depth = rays.depth(u, v);
    if (!depth) continue;
    const Vec3 before = rays.point(u, v, *depth - 1e-7), on = rays.point(u, v, *depth);
    ++seen;
    alike += norm(scene.surface->gradient(on) - scene.surface->gradient(before)) < 1e-5;
  }
  EXPECT_GE(alike, seen - 2);  // all but corners
}

TEST_P(SceneTest, CrossingsAreWhereTheSignChanges) {
  const SurfacePtr surface = make_scene(GetParam()).surface;
  NormalNumbers numbers(3, 0);
  for (int k = 0; k < 300; ++k) {
    const Vec3 origin = random_point(numbers), toward = random_point(numbers) - origin;
    std::vector<double> t;
    surface->crossings(origin, toward, t);
    std::sort(t.begin(), t.end());
    for (const double at : t) {
      const double scale = 1 + std::abs(at) * norm(toward);
      EXPECT_NEAR(surface->distance(origin + at * toward) / scale, 0, 1e-11);
    }
    const auto between = std::count_if(t.begin(), t.end(), [](double x) { return x > 0 && x < 1; });
    const bool changes =
        (surface->distance(origin) < 0) != (surface->distance(origin + toward) < 0);
    EXPECT_EQ(between % 2 == 1, changes);
  }
}

TEST_P(SceneTest, IsSeenAtItsPointOfContact) {
  const Scene scene = make_scene(GetParam());
  EXPECT_NEAR(scene.surface->distance({0, 0, 1}), 0, 1e-15);
  const DepthImage image = render(*scene.surface, scene.camera);
  EXPECT_NEAR(image.depth[image.index(320, 240)], 1, 2e-3);
}

TEST_P(SceneTest, EveryPixelSeesTheSurfaceFromFreeSpace) {
  const Scene scene = make_scene(GetParam());
  const DepthImage image = render(*scene.surface, scene.camera);
  const Vec3 eye = scene.camera.to_world.translation;
  std::size_t seen = 0;
  for (std::uint32_t v = 0; v < image.height; v += 7) {
    for (std::uint32_t u = 0; u < image.width; u += 7) {
      const double z = image.depth[image.index(u, v)];
      if (z == 0) continue;
      ++seen;
      const Vec3 p = unproject(scene.camera.intrinsics, u, v, z);
      EXPECT_NEAR(scene.surface->distance(p), 0, 1e-6 * norm(p));
      EXPECT_GT(scene.surface->distance(p + 1e-4 * (eye - p)), 0);
    }
  }
  EXPECT_GT(seen, 500u);
}

INSTANTIATE_TEST_SUITE_P(All, SceneTest, testing::ValuesIn(scene_names()),
                         [](const auto& scene) { return test::test_name(scene.param); });

TEST(Scenes, UnknownNameIsRefusedWithTheKnownOnes) {
  const auto fault = test::fault_of([] { make_scene("cellar"); });
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->kind(), ErrorKind::invalid_argument);
  EXPECT_NE(std::string(fault->what()).find("inverted-ball"), std::string::npos);
}

TEST(Render, PlacedCameraSeesTheSameWorld) {
  Scene scene = make_scene("wall");
  scene.camera.to_world.translation = {0.1, -0.2, 0.4};
  scene.camera.to_world.rotation = rotation_from_quaternion({0.1, 0, 0, std::sqrt(0.99)});
  const DepthImage image = render(*scene.surface, scene.camera);
  for (const std::uint32_t u : {0u, 320u, 639u}) {
    const double z = image.depth[image.index(u, 100)];
    ASSERT_GT(z, 0);
    const Vec3 p = scene.camera.to_world * unproject(scene.camera.intrinsics, u, 100, z);
    EXPECT_NEAR(p.z, 1, 1e-6);
  }
}

}  // namespace
}  // namespace vpm::synthetic
