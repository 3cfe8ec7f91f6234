#include "libvpm/recording/frame_feed.h"

#include <gtest/gtest.h>

#include <filesystem>

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
