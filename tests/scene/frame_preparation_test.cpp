#include "libvpm/scene/frame_preparation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "tests/query/lattice_model.h"
#include "tests/refusal.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

template <class T>
void add(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

// Returns the bytes of all that a query reads.
std::string bytes_of(const PreparedImage& cloud) {
  std::string bytes;
  add(bytes, cloud.positions().data(), cloud.positions().size());
  add(bytes, cloud.normals().data(), cloud.normals().size());
  add(bytes, cloud.pixel_begin().data(), cloud.pixel_begin().size());
  const Vec3 origin = cloud.origin();
  add(bytes, &origin, 1);
  const Pose camera = cloud.camera().to_world;
  add(bytes, &camera, 1);
  const DepthSurface surface = cloud.surface();
  add(bytes, surface.normals, cloud.pixel_begin().size() - 1);
  add(bytes, surface.measured, cloud.pixel_begin().size() - 1);
  for (int level = 0; level < surface.levels; ++level) {
    const std::size_t rows = static_cast<std::size_t>((surface.height - 1) >> level) + 1;
    add(bytes, surface.tiles[level], rows * static_cast<std::size_t>(surface.tiles_per_row(level)));
  }
  return bytes;
}

struct Frame {
  DepthImage depth;
  Camera camera;
};

// Returns a noisy ball in front of nothing, with holes of many widths and depths that are not valid
// numbers.
Frame frame(std::uint32_t width, std::uint32_t height) {
  synthetic::Scene scene = synthetic::make_scene("inverted-ball");
  scene.camera.width = width;
  scene.camera.height = height;
  scene.camera.intrinsics.cx = 0.5 * (width - 1);
  scene.camera.intrinsics.cy = 0.5 * (height - 1);
  scene.camera.to_world = {testing::generic_rotation(), {1e5, -3, 2}};
  synthetic::Scene straight = scene;
  straight.camera.to_world = {};
  Frame frame{synthetic::render_with_kinect_noise(*scene.surface, straight.camera, 5),
              scene.camera};
  for (std::uint32_t v = 0; v < height; ++v) {
    for (std::uint32_t u = 0; u < width; ++u) {
      float& depth = frame.depth.depth[frame.depth.index(u, v)];
      if ((u / 9) % 3 == 1 && u % 9 < 1 + v / 16 % 7) depth = 0;
      if ((u * 31 + v * 17) % 203 == 0) depth = std::numeric_limits<float>::quiet_NaN();
      if ((u * 29 + v * 13) % 307 == 0) depth = -1;
      if ((u * 23 + v * 11) % 401 == 0) depth *= 1.5F;
    }
  }
  return frame;
}

void expect_same(FramePreparation& preparation, const Frame& f, const NormalOptions& options,
                 PreparedImage& cloud, Denoising points = Denoising::on, bool has_points = true) {
  const PreparedImage expected(make_cloud(f.depth, f.camera, options), points);
  if (has_points) {
    ASSERT_GT(expected.positions().size(), 0u);
  }
  const std::uint64_t before = cloud.serial();
  preparation.prepare(f.depth, f.camera, cloud);
  EXPECT_TRUE(bytes_of(cloud) == bytes_of(expected));
  EXPECT_NE(cloud.serial(), before);
}

class FramePreparationOf : public ::testing::TestWithParam<NormalMethod> {};

INSTANTIATE_TEST_SUITE_P(Methods, FramePreparationOf,
                         ::testing::Values(NormalMethod::inverse_depth, NormalMethod::pca),
                         [](const auto& method) { return test::test_name(to_text(method.param)); });

TEST_P(FramePreparationOf, HasTheBitsOfTheCloud) {
  const NormalOptions options{GetParam(), 7, kEdgeGate};
  FramePreparation preparation(options);
  PreparedImage cloud;
  for (const int threads : {1, 4}) {
    set_thread_count(threads);
    // Frames share the memory of the frame before: larger, smaller, with fewer points and with
    // more.
    expect_same(preparation, frame(200, 150), options, cloud);
    Frame full = frame(200, 150);
    full.depth.depth.assign(full.depth.depth.size(), 1.0F);
    expect_same(preparation, full, options, cloud);
    expect_same(preparation, frame(61, 7), options, cloud);
    expect_same(preparation, frame(200, 150), options, cloud);
    expect_same(preparation, frame(333, 97), options, cloud);
  }
  set_thread_count(0);
}

TEST(FramePreparation, TakesImagesOfAnySize) {
  const NormalOptions options;
  FramePreparation preparation(options);
  PreparedImage cloud;
  for (const auto& [width, height] :
       {std::pair(1U, 1U), std::pair(1U, 65U), std::pair(65U, 1U), std::pair(33U, 33U)})
    expect_same(preparation, frame(width, height), options, cloud, Denoising::on,
                width > 1 && height > 1);
}

TEST(FramePreparation, TakesACloudWhoseMemoryWasMovedAway) {
  const NormalOptions options;
  FramePreparation preparation(options);
  PreparedImage cloud;
  const Frame f = frame(64, 48);
  expect_same(preparation, f, options, cloud);
  const PreparedImage taken = std::move(cloud);
  expect_same(preparation, f, options,
              cloud);  // NOLINT(bugprone-use-after-move): tests reuse after a move
  EXPECT_TRUE(bytes_of(taken) == bytes_of(cloud));
}

// A normal that is not of unit length is found when the rows are made.
TEST(FramePreparation, WhatIsRefusedLeavesNoCloudBehind) {
  const NormalOptions options{NormalMethod::inverse_depth, 7, 0};
  FramePreparation preparation(options);
  PreparedImage cloud;
  const Frame good = frame(64, 48);
  expect_same(preparation, good, options, cloud);
  Frame wild = good;
  for (std::size_t i = 0; i < wild.depth.depth.size(); ++i)
    wild.depth.depth[i] = i % 2 == 0 ? 1e-20F : 1e20F;
  const std::string message =
      test::refusal([&] { preparation.prepare(wild.depth, wild.camera, cloud); });
  EXPECT_NE(message, "");
  EXPECT_EQ(message,
            test::refusal([&] { PreparedImage{make_cloud(wild.depth, wild.camera, options)}; }));
  EXPECT_EQ(cloud.positions().size(), 0U);
  EXPECT_TRUE(cloud.pixel_begin().empty());
  expect_same(preparation, good, options, cloud);
}

// However narrow it is, what was removed stays unknown; a hole beside it is closed.
TEST(FramePreparation, ClosesNothingThatWasRemoved) {
  DepthImage image{40, 30, std::vector<float>(40 * 30, 1.0F)};
  for (std::uint32_t v = 0; v < image.height; ++v) {
    image.depth[image.index(10, v)] = kRemovedDepth;
    image.depth[image.index(20, v)] = image.depth[image.index(21, v)] = kRemovedDepth;
    image.depth[image.index(30, v)] = 0;
  }
  const Camera camera{{40, 40, 19.5, 14.5}, 40, 30, {}};
  PreparedImage frame;
  FramePreparation({}, Denoising::on).prepare(image, camera, frame);
  const PreparedImage cloud(make_cloud(image, camera, {}));
  for (const PreparedImage* prepared : {&std::as_const(frame), &cloud})
    for (int v = 1; v < 29; ++v)
      for (int u = 0; u < 40; ++u) {
        const bool is_removed = u == 10 || u == 20 || u == 21;
        const Vec3 place = unproject(camera.intrinsics, u, v, 0.5);
        EXPECT_EQ(prepared->surface().sight_at(place), is_removed ? Sight::hole : Sight::seen)
            << u << ' ' << v;
      }
  EXPECT_EQ(frame.positions().size(), cloud.positions().size());
  EXPECT_TRUE(is_removed(make_cloud(image, camera, {}).sensor->depth.depth[10]));
}

TEST(FramePreparation, ReadsPointsAsMeasured) {
  const NormalOptions options;
  FramePreparation preparation(options, Denoising::off);
  PreparedImage cloud;
  Frame f = frame(200, 150);
  expect_same(preparation, f, options, cloud, Denoising::off);
  f.camera.intrinsics = {3e6, 3e6, 31.5, 23.5};  // beyond usual intrinsics
  expect_same(preparation, f, options, cloud, Denoising::off);
}

TEST(FramePreparation, CamerasBeyondTheUsualAreNoOthers) {
  const NormalOptions options;
  FramePreparation preparation(options);
  PreparedImage cloud;
  Frame f = frame(64, 48);
  f.camera.intrinsics = {3e6, 3e6, 31.5, 23.5};
  expect_same(preparation, f, options, cloud);
  f.camera.intrinsics = {1e-2, 1e-2, 31.5, 23.5};
  expect_same(preparation, f, options, cloud);
}

TEST(FramePreparation, RefusesWhatCloudsAreRefusedFor) {
  const NormalOptions options;
  FramePreparation preparation(options);
  PreparedImage cloud;
  const auto expect_refusal = [&](const Frame& f, const std::string& part) {
    const std::string message =
        test::refusal([&] { preparation.prepare(f.depth, f.camera, cloud); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message,
              test::refusal([&] { PreparedImage{make_cloud(f.depth, f.camera, options)}; }));
  };
  Frame f = frame(64, 48);
  f.camera.intrinsics.fx = 0;
  expect_refusal(f, "intrinsics");
  f = frame(64, 48);
  f.depth.depth.pop_back();
  expect_refusal(f, "3071 values");
  f = frame(64, 48);
  f.camera.width = 63;
  expect_refusal(f, "not as large");
  f = frame(DepthSurface::kMostPixelsASide + 1, 1);
  expect_refusal(f, "65536 pixels wide or high");
  f = frame(1, DepthSurface::kMostPixelsASide + 1);
  expect_refusal(f, "65536 pixels wide or high");
  f = frame(64, 48);
  f.camera.to_world.translation.x = 0x1p101;
  expect_refusal(f, "2^100 m");
  f = frame(64, 48);
  f.camera.to_world.rotation.row0.x += 0.01;
  expect_refusal(f, "not a rotation");
  f = frame(64, 48);
  f.depth.depth.assign(f.depth.depth.size(), 1.1F);
  f.camera.intrinsics = {1e9, 1e9, 31.5, 23.5};
  expect_refusal(f, "does not lie on the ray");
  EXPECT_THROW(FramePreparation({NormalMethod::pca, 8, kEdgeGate}), Error);
}

}  // namespace
}  // namespace vpm
