#include "libvpm/recording/transform_tree.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

constexpr std::uint64_t kMillisecond = 1'000'000;  // ns

Pose at(double x, double y = 0, double z = 0) {
  return {{}, {x, y, z}};
}

TEST(ATransformTree, TellsMotionsAlongAllLinksAtTheTimesThatAllHave) {
  TransformTree tree;
  tree.add("arm", "world", at(1), 1000 * kMillisecond, false);
  tree.add("arm", "world", at(3), 3000 * kMillisecond, false);
  tree.add("tool", "arm", at(0, 1), 500 * kMillisecond, false);
  tree.add("tool", "arm", at(0, 9), 1500 * kMillisecond, false);
  tree.add("tool", "arm", at(7, 7), 1500 * kMillisecond, false);  // of one time the first counts
  tree.add("tip", "tool", at(0, 0, 5), 99 * kMillisecond, true);
  tree.add("tip", "tool", at(0, 0, 2), 100 * kMillisecond, true);  // stands still at the last
  const std::string expected =
      "1.000000000 1 5 2 0 0 0 1\n"
      "1.500000000 1.5 9 2 0 0 0 1\n";
  for (const char* const world : {"", "world"}) {
    const FrameMotion motion = tree.motion("tip", world, "rec");
    EXPECT_EQ(motion.lines, expected);
    EXPECT_EQ(motion.world, "world");
  }
  EXPECT_EQ(tree.motion("tip", "tool", "rec").lines, " 0 0 2 0 0 0 1\n");
  EXPECT_EQ(tree.motion("tool", "tip", "rec").lines, " 0 0 -2 0 0 0 1\n");
}

TEST(ATransformTree, RefusesFramesWhosePoseItDoesNotKnow) {
  TransformTree tree;
  tree.add("a", "b", at(1), 0, true);
  tree.add("b", "a", at(1), 0, true);
  tree.add("c", "d", at(1), 0, true);
  tree.add("c", "e", at(1), 1, true);
  tree.add("f", "g", at(1), 0, true);
  const auto fault = [&](const char* frame, const char* world) {
    return test::refusal([&] { tree.motion(frame, world, "rec"); });
  };
  EXPECT_TRUE(says(fault("a", ""), "rec: TF puts the frame b into itself"));
  EXPECT_TRUE(says(fault("c", ""), "rec: TF puts the frame c into two others, e and d"));
  for (const char* const frame : {"g", "h"})
    EXPECT_TRUE(says(fault(frame, ""), "TF does not tell the pose of the frame"));
  EXPECT_TRUE(says(fault("f", "h"), "the frame f in h; it has poses of a, b, c, f; name frames"));
}

}  // namespace
}  // namespace vpm
