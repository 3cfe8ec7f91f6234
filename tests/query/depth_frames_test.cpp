// Tests depth frames on the CPU; tests/cuda tests those on a device.

#include "libvpm/scene/depth_frames.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

constexpr Intrinsics kIntrinsics{525, 525, 39.5, 29.5};

DepthFrameOptions options_of(std::optional<double> counts_per_metre = {}) {
  return {kIntrinsics, 80, 60, counts_per_metre, {}, {}};
}

DepthImage wall() {
  const synthetic::Scene scene = synthetic::make_scene("tilted-wall");
  return synthetic::render(*scene.surface, {kIntrinsics, 80, 60, {}});
}

Result query_in(const DepthImage& image, const Pose& camera, const Pose& pose) {
  const DepthBody cloud(make_cloud(image, {kIntrinsics, 80, 60, camera}, {}));
  return ToolQuery(testing::lattice_cube(0.1, 6, 2), {}).run(cloud, pose);
}

const Pose kPose{testing::generic_rotation(), {0, 0, 0.98}};

TEST(DepthFrames, AnswerAsACloudOfTheSameImage) {
  const DepthImage image = wall();
  const ToolModel tool = testing::lattice_cube(0.1, 6, 2);
  ToolQuery query(tool, {});
  DepthFrames frames(options_of());
  std::copy(image.depth.begin(), image.depth.end(), frames.metres().begin());
  const DepthBody frame = frames.prepare({});
  const Result expected = query_in(image, {}, kPose), found = query.run(frame, kPose);
  EXPECT_GT(expected.boundary, 0U);
  testing::expect_equal(expected, found);
  EXPECT_EQ(frame.points(), image.depth.size());
  const Pose poses[] = {kPose, kPose};
  Result results[2];
  query.run(frame, jobs_of(poses), results);
  testing::expect_equal(expected, results[1]);
}

TEST(DepthFrames, AreReadAsMeasuredWhereThatIsAsked) {
  const synthetic::Scene scene = synthetic::make_scene("tilted-wall");
  const Camera camera{kIntrinsics, 80, 60, {}};
  const DepthImage image = synthetic::render_with_kinect_noise(*scene.surface, camera, 1);
  const ToolModel tool = testing::lattice_cube(0.1, 6, 2);
  DepthFrameOptions options = options_of();
  Result found[2];
  for (const Denoising points : {Denoising::on, Denoising::off}) {
    options.points = points;
    DepthFrames frames(options);
    std::copy(image.depth.begin(), image.depth.end(), frames.metres().begin());
    Result& result = found[points == Denoising::on ? 0 : 1];
    result = ToolQuery(tool, {}).run(frames.prepare({}), kPose);
    testing::expect_equal(
        result, ToolQuery(tool, {}).run(DepthBody(make_cloud(image, camera, {}), points), kPose));
  }
  EXPECT_NE(found[0].volume, found[1].volume);
}

TEST(DepthFrames, OfCountsAreThoseOfTheirMetres) {
  DepthImage image = wall();
  DepthFrames frames(options_of(4000.0));
  const std::span<std::uint16_t> counts = frames.counts();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i] = static_cast<std::uint16_t>(4000 * image.depth[i]);
    image.depth[i] = static_cast<float>(counts[i] / 4000.0);
  }
  const ToolModel tool = testing::lattice_cube(0.1, 6, 2);
  testing::expect_equal(query_in(image, {}, kPose),
                        ToolQuery(tool, {}).run(frames.prepare({}), kPose));
}

TEST(DepthFrames, StayAsTheyWereWhileOthersCome) {
  DepthFrames frames(options_of());
  const auto prepare = [&](float depth) {
    std::ranges::fill(frames.metres(), depth);
    return frames.prepare({});
  };
  const DepthBody near = prepare(1);
  for (int k = 0; k < 4; ++k) {
    const DepthBody far = prepare(2);
    EXPECT_EQ(near.prepared().positions().front().z, 1);
    EXPECT_EQ(far.prepared().positions().front().z, 2);
  }
}

TEST(DepthFrames, TakeTheMemoryOfThoseThatNobodyHolds) {
  DepthFrames frames(options_of());
  const float* const first = frames.metres().data();
  std::optional<DepthBody> held = frames.prepare({});
  const float* const second = frames.metres().data();
  EXPECT_NE(first, second);
  held = frames.prepare({});
  EXPECT_EQ(frames.metres().data(), first);
}

TEST(DepthFrames, RefuseWhatTheyCannotBeMadeOf) {
  const auto made_with = [&](const auto& change) {
    DepthFrameOptions options = options_of();
    change(options);
    return test::kind_of_fault([&] { DepthFrames frames(options); });
  };
  EXPECT_EQ(made_with([](auto& o) { o.width = 0; }), ErrorKind::invalid_argument);
  EXPECT_EQ(made_with([](auto& o) { o.intrinsics.fx = 0; }), ErrorKind::invalid_argument);
  EXPECT_EQ(made_with([](auto& o) { o.normals.window = 4; }), ErrorKind::invalid_argument);
  EXPECT_EQ(made_with([](auto& o) { o.counts_per_metre = 0; }), ErrorKind::invalid_argument);
  DepthFrames metres(options_of()), counts(options_of(1000.0));
  EXPECT_EQ(test::kind_of_fault([&] { metres.counts(); }), ErrorKind::invalid_argument);
  EXPECT_EQ(test::kind_of_fault([&] { counts.metres(); }), ErrorKind::invalid_argument);
  Pose mirrored;
  mirrored.rotation.row0.x = -1;
  EXPECT_EQ(test::kind_of_fault([&] { metres.prepare(mirrored); }), ErrorKind::refused);
}

}  // namespace
}  // namespace vpm
