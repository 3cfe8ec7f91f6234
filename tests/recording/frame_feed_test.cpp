#include "libvpm/recording/frame_feed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "tests/import/test_files.h"
#include "tests/temporary_folder.h"

namespace vpm {
namespace {

constexpr std::uint32_t kWidth = 16, kHeight = 12;

ImportOptions camera() {
  ImportOptions options;
  options.intrinsics = Intrinsics{16, 16, 7.5, 5.5};
  return options;
}

// Sets up walls at 1 m, 1.01 m, ...; a frame every 10 ms; some are empty, broken or lost.
class AFeed : public test::InTemporaryFolder {
 protected:
  void SetUp() override {
    for (std::size_t k = 0; k < 12; ++k) {
      const std::string name = path(std::to_string(k) + ".png");
      const auto depth = static_cast<std::uint16_t>(k == kEmpty ? 0 : 1000 + 10 * k);
      file::write_all(name, k == kBroken
                                ? std::string("no image")
                                : make_png(kWidth, kHeight, 16,
                                           std::vector<std::uint16_t>(kWidth * kHeight, depth)));
      recording_.frames.push_back({0.01 * static_cast<double>(k), name, {}, k == kLost});
    }
  }
  // Returns the depth of the wall that a cloud shows.
  static double wall(const AnyBody& cloud) {
    return cloud.positions().empty() ? 0 : widen(cloud.positions().front()).z;
  }
  bool is_bad(const RecordedFrame& frame) const {
    return frame.is_lost || frame.path == path(std::to_string(kEmpty) + ".png") ||
           frame.path == path(std::to_string(kBroken) + ".png");
  }
  static constexpr std::size_t kEmpty = 3, kBroken = 4, kLost = 7;

  Recording recording_;
};

TEST_F(AFeed, HoldsTheLastGoodFrame) {
  const ScheduleOptions schedule{1000, 120, -0.005, 0, false};
  FrameFeed feed(recording_, schedule, camera());
  for (std::size_t step = 0; step < schedule.steps; ++step) {
    feed.advance_to(step);
    if (step < 5) {
      EXPECT_FALSE(feed.frame());
      EXPECT_EQ(wall(feed.body()), 0);
      continue;
    }
    std::size_t frame = (step - 5) / 10;
    if (frame == kEmpty || frame == kBroken) frame = kEmpty - 1;
    if (frame == kLost) frame = kLost - 1;
    ASSERT_EQ(feed.frame(), frame) << step;
    EXPECT_NEAR(wall(feed.body()), 1 + 0.01 * static_cast<double>(frame), 1e-6);
  }
  EXPECT_EQ(feed.counts().used, 9u);
  EXPECT_EQ(feed.counts().empty, 1u);
  EXPECT_EQ(feed.counts().broken, 1u);
  EXPECT_EQ(feed.counts().lost, 1u);
  EXPECT_EQ(feed.counts().unseen, 0u);
}

TEST_F(AFeed, TakesTheNewestOfThoseThatComeTogether) {
  FrameFeed feed(recording_, {20, 3, 0, 0, false}, camera());  // five frames a step
  std::vector<std::size_t> seen;
  for (std::size_t step = 0; step < 3; ++step) {
    feed.advance_to(step);
    seen.push_back(*feed.frame());
  }
  EXPECT_EQ(seen, (std::vector<std::size_t>{0, 5, 10}));
  EXPECT_EQ(feed.counts().unseen, 8u);
}

TEST_F(AFeed, PutsCloudsWhereTheirCameraStood) {
  for (RecordedFrame& frame : recording_.frames) frame.camera = Pose{{}, {3, 4, 5}};
  FrameFeed feed(recording_, {1000, 1, 0, 0, false}, camera());
  feed.advance_to(0);
  EXPECT_EQ(feed.body().to_world().translation, (Vec3{3, 4, 5}));
}

// Another camera, with other pixels and times: each step sees what a scene made afresh of the last
// frames of both would show, in bits, and nothing of those before.
TEST_F(AFeed, HasTheLastFrameOfEachCamera) {
  Recording other;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::string name = path("other" + std::to_string(k) + ".png");
    const auto depth = static_cast<std::uint16_t>(900 + 25 * k);
    file::write_all(name, make_png(24, 20, 16, std::vector<std::uint16_t>(24 * 20, depth)));
    other.frames.push_back(
        {0.012 + 0.031 * static_cast<double>(k), name, Pose{{}, {0.1, 0, -0.1}}});
    other.frames.back().intrinsics = Intrinsics{30, 30, 11.5, 9.5};
  }
  const Recording both = joined({recording_, other});
  const auto afresh = [&](const std::vector<std::size_t>& frames) {
    std::vector<DepthBody> images;
    for (const std::size_t frame : frames) {
      const ImportedScan scan = read_frame(both.frames[frame], camera());
      images.emplace_back(make_cloud(scan.image->depth, scan.image->camera, {}));
    }
    return body_of_cameras(images);
  };
  FrameFeed feed(both, {1000, 120, 0, 0, false}, camera());
  int of_both = 0;
  for (std::size_t step = 0; step < 120; ++step) {
    if (feed.advance_to(step) == nullptr) continue;
    std::vector<std::size_t> last(2, both.frames.size());
    for (std::size_t k = 0; k < both.frames.size(); ++k) {
      const RecordedFrame& frame = both.frames[k];
      const bool is_good = frame.source == 1 || !is_bad(frame);
      if (frame.time <= 0.001 * static_cast<double>(step) + 1e-9 && is_good) last[frame.source] = k;
    }
    std::erase(last, both.frames.size());
    ASSERT_EQ(feed.frames(), last) << step;
    const AnyBody expected = afresh(last);
    ASSERT_EQ(feed.body().positions(), expected.positions()) << step;
    const RigBody *rig = feed.body().as<RigBody>(), *rig_afresh = expected.as<RigBody>();
    ASSERT_EQ(rig == nullptr, rig_afresh == nullptr);
    if (rig == nullptr) continue;
    ++of_both;
    for (int k = 0; k < 200; ++k) {
      const Vec3 x{0.3 * std::sin(12.9 * k), 0.3 * std::sin(78.2 * k + 1),
                   1 + 0.1 * std::sin(37.7 * k)};
      const SurfaceSample seen = rig->surface().sample(x), there = rig_afresh->surface().sample(x);
      ASSERT_EQ(seen.known, there.known);
      if (!seen.known) continue;
      EXPECT_EQ(seen.distance, there.distance) << step;
    }
  }
  EXPECT_GT(of_both, 8);
  EXPECT_EQ(feed.counts().used, 13u);
  EXPECT_EQ(feed.counts().unseen, 0u);
}

TEST_F(AFeed, OfSeveralTakesDepthImagesAndOneClockOnly) {
  Cloud cloud;
  cloud.positions = {{0, 0, 1}, {0.1F, 0, 1}, {0, 0.1F, 1}};
  cloud.normals.assign(3, {0, 0, -1});
  cloud.radii.assign(3, 0.1F);
  write_cloud(path("points.vpmc"), cloud);
  Recording points;
  points.frames.push_back({0, path("points.vpmc"), {}});
  const Recording both = joined({points, recording_});
  FrameFeed feed(both, {1000, 10, 0, 0, false}, camera());
  EXPECT_THROW(feed.advance_to(0), Error);
  points.has_clock = false;
  EXPECT_THROW(joined({points, recording_}), Error);
}

TEST_F(AFeed, MayBeLeftAtAnyStep) {
  for (const std::size_t steps : {0, 1, 25}) {
    FrameFeed feed(recording_, {1000, 1000000, 0, 0, true}, camera());
    for (std::size_t step = 0; step < steps; ++step) feed.advance_to(step);
  }
}

TEST_F(AFeed, SaysWhatIsWrongWithTheCall) {
  FrameFeed feed(recording_, {1000, 10, 0, 0, false}, ImportOptions{});  // without intrinsics
  EXPECT_THROW(feed.advance_to(0), Error);
}

}  // namespace
}  // namespace vpm
