// Depth images prepared by the device, and queries on them, have the bits of the CPU's.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <random>
#include <thread>

#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "tests/cuda/effort.h"
#include "tests/cuda/frame_memory.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"
#include "tests/query/ring_of_cameras.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

using testing::expect_equal;

const Device kDevice{Device::Kind::cuda, 0};
const Pose kFarPose{testing::generic_rotation(), {1e6, -3, 2}};

using Depths = std::function<float(std::uint32_t u, std::uint32_t v, std::mt19937& random)>;

float uniform(std::mt19937& random, float low, float high) {
  return low + (high - low) * static_cast<float>(random() >> 8) * 0x1p-24F;
}

// Returns a tilted wall with holes and noise.
Depths wall(float hole_cell, float noise) {
  return [=](std::uint32_t u, std::uint32_t v, std::mt19937& random) {
    const float z = 1.0F / (1.0F + 1e-3F * static_cast<float>(u) - 5e-4F * static_cast<float>(v));
    const float noisy = z * (1 + uniform(random, -noise, noise));
    return uniform(random, 0, 1) < hole_cell ? 0.0F : noisy;
  };
}

const std::pair<const char*, Depths> kImages[] = {
    {"wall", wall(0, 0)},
    {"wall with noise", wall(0, 0.004F)},
    {"wall with holes", wall(0.1F, 0.004F)},
    {"mostly holes", wall(0.7F, 0.002F)},
    {"noise", [](auto, auto, auto& random) { return uniform(random, 0.4F, 4); }},
    {"nothing", [](auto, auto, auto&) { return 0.0F; }},
    {"one pixel", [](auto u, auto v, auto&) { return u == 3 && v == 2 ? 1.5F : 0.0F; }},
    {"steps",
     [](auto u, auto v, auto& random) {
       return (1 + 0.1F * static_cast<float>((u / 9 + v / 7) % 3)) *
              uniform(random, 0.999F, 1.001F);
     }},
    {"stripes and what is no measurement",
     [](auto u, auto v, auto& random) {
       const float odd[] = {NAN, -1, HUGE_VALF, 1e-30F, 1e30F, 0};
       return (u + 2 * v) % 4 == 0 ? odd[random() % 6] : 0.8F;
     }},
    {"narrow strips that were removed, among holes",
     [](auto u, auto v, auto& random) {
       const float z = wall(0.1F, 0.004F)(u, v, random);
       return (u + v / 3) % 11 < 2 ? kRemovedDepth : z;
     }},
};

DepthImage image_of(const Depths& depths, std::uint32_t width, std::uint32_t height) {
  std::mt19937 random(width * 7919 + height);
  DepthImage image{width, height, {}};
  for (std::uint32_t v = 0; v < height; ++v) {
    for (std::uint32_t u = 0; u < width; ++u) image.depth.push_back(depths(u, v, random));
  }
  return image;
}

DepthFrameOptions options_of(const DepthImage& image, const NormalOptions& normals) {
  return {{525, 510, 0.5 * image.width - 0.7, 0.5 * image.height},
          image.width,
          image.height,
          {},
          normals,
          kDevice};
}

DepthBody prepared(const DepthImage& image, const DepthFrameOptions& options, const Pose& camera) {
  return DepthBody(
      make_cloud(image, {options.intrinsics, image.width, image.height, camera}, options.normals));
}

DepthBody frame_of(DepthFrames& frames, const DepthImage& image, const Pose& camera) {
  std::memcpy(frames.metres().data(), image.depth.data(), image.depth.size() * sizeof(float));
  return frames.prepare(camera);
}

void expect_same(const DepthImage& image, const NormalOptions& normals) {
  const DepthFrameOptions options = options_of(image, normals);
  DepthFrames frames(options);
  for (const Pose& camera : {Pose{}, kFarPose}) {
    const DepthBody frame = frame_of(frames, image, camera);
    const auto memory = testing::memory_on_device(frame);
    ASSERT_TRUE(memory);
    const DepthBody cloud = prepared(image, options, camera);
    EXPECT_TRUE(testing::same_bits(*memory, testing::memory_of(cloud.prepared())));
    EXPECT_EQ(frame.points(), cloud.points());
  }
}

class SameFrame : public ::testing::TestWithParam<NormalMethod> {
 protected:
  void SetUp() override {
    if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  }
};
INSTANTIATE_TEST_SUITE_P(Methods, SameFrame,
                         ::testing::Values(NormalMethod::inverse_depth, NormalMethod::pca),
                         [](const auto& method) { return test::test_name(to_text(method.param)); });

TEST_P(SameFrame, OfImagesOfAnySize) {
  const std::pair<std::uint32_t, std::uint32_t> sizes[] = {
      {1, 1}, {2, 1}, {1, 9}, {7, 7}, {31, 15}, {32, 16}, {33, 17}, {97, 61}, {640, 480}};
  for (const auto& [name, depths] : kImages) {
    for (const auto& [width, height] : sizes) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(width) + " x " +
                   std::to_string(height));
      expect_same(image_of(depths, width, height), {GetParam()});
    }
  }
}

TEST_P(SameFrame, AsMeasured) {
  for (const auto& [name, depths] : kImages) {
    const DepthImage image = image_of(depths, 97, 61);
    DepthFrameOptions options = options_of(image, {GetParam()});
    options.points = Denoising::off;
    DepthFrames frames(options);
    const auto memory = testing::memory_on_device(frame_of(frames, image, kFarPose));
    ASSERT_TRUE(memory);
    const Camera camera{options.intrinsics, image.width, image.height, kFarPose};
    EXPECT_TRUE(testing::same_bits(
        *memory, testing::memory_of(
                     PreparedImage(make_cloud(image, camera, options.normals), Denoising::off))));
  }
}

TEST_P(SameFrame, WithAnyWindowAndGate) {
  for (const auto& [name, depths] : kImages) {
    const DepthImage image = image_of(depths, 83, 45);
    for (const int window : {3, 5, 7, 9, 17, 31}) {
      for (const double gate : {0.0, 0.002, 0.02, 0.5}) {
        SCOPED_TRACE(std::string(name) + " " + std::to_string(window) + " " + std::to_string(gate));
        expect_same(image, {GetParam(), window, gate});
      }
    }
  }
}

TEST_P(SameFrame, OfCounts) {
  const DepthImage seen = image_of(wall(0.05F, 0.003F), 97, 61);
  for (const double counts_per_metre : {1000.0, 5000.0, 0.37, 12345.678}) {
    DepthFrameOptions options = options_of(seen, {GetParam()});
    options.counts_per_metre = counts_per_metre;
    DepthFrames frames(options);
    DepthImage image = seen;
    const std::span<std::uint16_t> counts = frames.counts();
    for (std::size_t i = 0; i < counts.size(); ++i) {
      counts[i] = static_cast<std::uint16_t>(seen.depth[i] * 5000);
      image.depth[i] = depth_in_metres(counts[i], counts_per_metre);
    }
    const DepthBody frame = frames.prepare(kFarPose);
    const auto memory = testing::memory_on_device(frame);
    ASSERT_TRUE(memory);
    const DepthBody cloud = prepared(image, options, kFarPose);
    EXPECT_TRUE(testing::same_bits(*memory, testing::memory_of(cloud.prepared())));
  }
}

// Depths span the whole range of lengths without a gate, so sums overflow and normals may not be of
// unit length. Both refuse the same images, and the others have the same bits.
TEST_P(SameFrame, OrTheSameRefusal) {
  const auto wild = [](auto, auto, auto& random) {
    return std::ldexp(1.0F, static_cast<int>(random() % 150) - 75);
  };
  const ToolModel tool = testing::lattice_cube(0.2, 4, 2);
  QueryOptions query_options;
  query_options.device = kDevice;
  ToolQuery query(tool, query_options);
  const Intrinsics all_intrinsics[] = {{525, 525, 20, 10},
                                       {1e-3, 1e-3, 20, 10},
                                       {1e-35, 9, 3, 10},
                                       {1e9, 1e9, 0, 0},
                                       {525, 525, 1e9, 0}};
  for (const Depths& depths : {Depths(wild), wall(0.1F, 0.01F)}) {
    for (const double gate : {0.0, 0.02}) {
      for (const Intrinsics& intrinsics : all_intrinsics) {
        const DepthImage image = image_of(depths, 37, 23);
        DepthFrameOptions options = options_of(image, {GetParam(), 7, gate});
        options.intrinsics = intrinsics;
        DepthFrames frames(options);
        std::string expected, found;
        Result at_host, at_device;
        const Pose pose{testing::generic_rotation(), {0, 0, 0.9}};
        try {
          const DepthBody cloud = prepared(image, options, {});
          at_host = ToolQuery(tool, {}).run(cloud, pose);
        } catch (const Error& fault) {
          expected = fault.what();
        }
        try {
          at_device = query.run(frame_of(frames, image, {}), pose);
        } catch (const Error& fault) {
          found = fault.what();
        }
        EXPECT_EQ(expected, found);
        expect_equal(at_host, at_device);
      }
    }
  }
}

Pose pose_of(int k) {
  return {testing::generic_rotation(), {0.02 * std::sin(k), 0.03 * std::cos(k), 0.8 + 0.01 * k}};
}

// Queries of several threads use one frame while the next is prepared.
TEST(FramesOnDevice, MayBeQueriedWhileTheNextIsPrepared) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const Camera camera = synthetic::default_camera();
  const auto scene = synthetic::make_scene("wall");
  const ToolModel tool = testing::lattice_cube(0.2, 9, 3);
  DepthFrames frames({camera.intrinsics, camera.width, camera.height, {}, {}, kDevice});
  std::vector<DepthImage> images;
  for (std::uint64_t k = 0; k < 4; ++k)
    images.push_back(synthetic::render_with_kinect_noise(*scene.surface, camera, k));
  QueryOptions options;
  ToolQuery on_cpu(tool, options);
  options.device = kDevice;
  ToolQuery first(tool, options), second(tool, options);
  std::uint32_t boundary = 0;
  DepthBody frame = frame_of(frames, images[0], camera.to_world);
  for (int k = 0; k < testing::effort(12); ++k) {
    const DepthBody next = frame_of(frames, images[(k + 1) % 4], camera.to_world);
    const DepthBody cloud(make_cloud(images[k % 4], camera, {}));
    const Result expected = on_cpu.run(cloud, pose_of(k));
    boundary += expected.boundary;
    std::thread other([&, frame] { expect_equal(expected, second.run(frame, pose_of(k))); });
    expect_equal(expected, first.run(frame, pose_of(k)));
    const Pose poses[] = {pose_of(k), pose_of(k)};
    Result results[2];
    first.run(frame, jobs_of(poses), results);
    expect_equal(expected, results[1]);
    other.join();
    EXPECT_EQ(frame.points(), cloud.points());
    frame = next;
  }
  EXPECT_GE(boundary, testing::expected_of(100));
}

// Rigs of frames that the device has prepared, alone and beside a cloud, give the bits of the
// CPU's.
TEST(FramesOnDevice, OfSeveralCameras) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  const auto scene = synthetic::make_union(
      {synthetic::make_block({0.24, 0.18, 0.2}, {testing::generic_rotation(), {}}),
       synthetic::make_inverted_ball({}, 1.5)});
  std::vector<Camera> cameras = testing::ring_of_cameras(3);
  std::vector<DepthFrames> frames;
  for (Camera& camera : cameras) {
    camera = testing::with_larger_pixels(camera, 8, 8);
    frames.push_back(
        DepthFrames({camera.intrinsics, camera.width, camera.height, {}, {}, kDevice}));
  }
  const ToolModel tool = testing::lattice_cube(0.12, 6, 3);
  ToolQuery on_cpu(tool, {}), on_device(tool, {.device = kDevice});
  for (std::uint32_t round = 0; round < 2; ++round) {  // the second in the memory of the first
    std::vector<DepthBody> made, clouds;
    for (std::size_t k = 0; k < cameras.size(); ++k) {
      DepthImage image = synthetic::render(*scene, cameras[k]);
      for (std::uint32_t p = round; p < image.depth.size(); p += 37) image.depth[p] = 0;
      made.push_back(frame_of(frames[k], image, cameras[k].to_world));
      clouds.emplace_back(make_cloud(image, cameras[k], {}));
    }
    const RigBody expected(clouds), found(made), mixed({clouds[0], made[1], made[2]});
    std::vector<Pose> poses(64, pose_of(0));  // the host's first question, by all its threads
    std::vector<Result> results(poses.size());
    on_cpu.run(found, jobs_of(poses), results);
    expect_equal(on_cpu.run(expected, poses[0]), results.back());
    double most = 0;
    for (int k = 0; k < 6; ++k) {
      const Pose pose{testing::generic_rotation(), {0.05 * std::cos(k), 0.05 * std::sin(k), 0.05}};
      const Result result = on_cpu.run(expected, pose);
      most = std::max(most, result.volume_fraction);
      expect_equal(result, on_device.run(found, pose));
      expect_equal(result, on_device.run(mixed, pose));
      expect_equal(result, on_cpu.run(found, pose));
    }
    EXPECT_GT(most, 0.3);
    EXPECT_EQ(expected.points(), found.points());
  }
}

// Prepares images in turn in the same memory.
TEST_P(SameFrame, EachImageAnew) {
  std::vector<DepthImage> images;
  for (int k = 0; k < 3; ++k) {
    images.push_back(image_of(wall(0.02F, 0.002F), 320, 240));
    for (float& z : images.back().depth) z *= 1 + 0.02F * static_cast<float>(k);
  }
  const DepthFrameOptions options = options_of(images[0], {GetParam()});
  const ToolModel tool = testing::lattice_cube(0.12, 9, 3);
  const Pose cameras[] = {{}, {testing::generic_rotation(), {0.3, -3, 2}}};
  const Pose pose{testing::generic_rotation(), {0.01, 0.02, 0.9}};
  ToolQuery on_cpu(tool, {});
  std::vector<Result> expected;
  for (int k = 0; k < 6; ++k)
    expected.push_back(
        on_cpu.run(prepared(images[k % 3], options, cameras[k % 2]), cameras[k % 2] * pose));
  ToolQuery query(tool, {.device = kDevice});
  DepthFrames frames(options);
  for (int k = 0; k < testing::effort(120); ++k) {
    SCOPED_TRACE(k);
    const DepthBody frame = frame_of(frames, images[k % 3], cameras[k % 2]);
    expect_equal(expected[k % 6], query.run(frame, cameras[k % 2] * pose));
  }
  EXPECT_NE(expected[0].volume, expected[1].volume);
}

// Reuses a frame's memory while its surface is still being made.
TEST_P(SameFrame, InMemoryThatIsUsedAgainAtOnce) {
  const DepthImage image = image_of(wall(0.05F, 0.002F), 1024, 1024);
  const DepthFrameOptions options = options_of(image, {GetParam()});
  const Pose cameras[] = {{}, {testing::generic_rotation(), {0.3, -3, 2}}};
  const Pose pose{testing::generic_rotation(), {0, 0, 0.8}};
  const ToolModel tool = testing::lattice_cube(0.3, 9, 3);
  ToolQuery on_cpu(tool, {}), query(tool, {.device = kDevice});
  Result expected[2];
  for (int k = 0; k < 2; ++k)
    expected[k] = on_cpu.run(prepared(image, options, cameras[k]), cameras[k] * pose);
  EXPECT_GT(expected[0].boundary, 0U);
  DepthFrames frames(options);
  frame_of(frames, image, cameras[0]);
  for (int round = 0; round < 20; ++round) {
    frames.prepare(cameras[0]).points();
    const DepthBody frame = frames.prepare(cameras[1]);
    expect_equal(expected[1], query.run(frame, cameras[1] * pose));
  }
}

// Small enough for compute-sanitizer.
TEST(FramesOnDevice, SmallQuery) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  for (const NormalMethod method : {NormalMethod::inverse_depth, NormalMethod::pca}) {
    for (const int window : {7, 9}) {
      for (const auto& [name, depths] : kImages) {
        SCOPED_TRACE(name);
        expect_same(image_of(depths, 83, 45), {method, window});
      }
    }
  }
  const DepthImage image = image_of(wall(0.05F, 0.002F), 83, 45);
  const ToolModel tool = testing::lattice_cube(0.05, 4, 3);
  QueryOptions options;
  options.device = kDevice;
  ToolQuery query(tool, options);
  DepthFrames frames(options_of(image, {}));
  const DepthBody frame = frame_of(frames, image, {});
  const Pose pose{testing::generic_rotation(), {0, 0, 0.95}};
  const Result expected = ToolQuery(tool, {}).run(DepthBody(frame.prepared()), pose);
  EXPECT_GT(expected.boundary, 0U);
  expect_equal(expected, query.run(frame, pose));
}

}  // namespace
}  // namespace vpm
