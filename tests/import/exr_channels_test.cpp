#include "libvpm/import/exr_channels.h"

#include <gtest/gtest.h>

#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

using Indices = std::vector<std::size_t>;

Indices chosen(const std::vector<ExrChannelName>& channels, const std::string& asked = "") {
  return depth_channels(channels, asked, "file");
}
std::string refused(const std::vector<ExrChannelName>& channels, const std::string& asked = "") {
  return test::refusal([&] { chosen(channels, asked); });
}

TEST(ExrChannels, NamesTellDepthInAnyLayerAndPart) {
  EXPECT_EQ(chosen({{"", "B"}, {"", "G"}, {"", "R"}, {"", "Z"}}), (Indices{3}));
  EXPECT_EQ(chosen({{"", "R"}, {"", "G"}, {"", "B"}, {"", "ViewLayer.Depth.Z"}}), (Indices{3}));
  EXPECT_EQ(chosen({{"colour", "R"}, {"colour", "G"}, {"colour", "B"}, {"depth", "Y"}}),
            (Indices{3}));
  EXPECT_EQ(chosen({{"", "Depth.V"}, {"", "Image.V"}}), (Indices{0}));
  EXPECT_EQ(chosen({{"", "depth.B"}, {"", "depth.G"}, {"", "depth.R"}, {"", "Image.R"}}),
            (Indices{2, 1, 0}));
}

TEST(ExrChannels, VectorsAndMistAreNoDepth) {
  EXPECT_EQ(
      chosen(
          {{"", "Normal.X"}, {"", "Normal.Y"}, {"", "Normal.Z"}, {"", "Depth.Z"}, {"", "Mist.Z"}}),
      (Indices{3}));
  EXPECT_TRUE(says(refused({{"", "Normal.X"}, {"", "Normal.Y"}, {"", "Normal.Z"}}),
                   "no channel is surely depth: Normal.Z stands beside X and Y"));
  const std::string points = refused({{"", "depth.X"}, {"", "depth.Y"}, {"", "depth.Z"}});
  EXPECT_TRUE(says(points, "depth.Z stands beside X and Y")) << points;
  EXPECT_FALSE(says(points, "no channel's name says depth")) << points;
  EXPECT_TRUE(says(refused({{"", "Mist.Z"}}), "no channel's name says depth"));
}

TEST(ExrChannels, OtherNamesCountOnlyWhenAlone) {
  EXPECT_EQ(chosen({{"", "Y"}}), (Indices{0}));
  EXPECT_EQ(chosen({{"", "V"}}), (Indices{0}));
  EXPECT_TRUE(says(refused({{"", "BY"}, {"", "RY"}, {"", "Y"}}), "it has BY, RY, Y"));
  EXPECT_EQ(chosen({{"", "A"}, {"", "B"}, {"", "G"}, {"", "R"}}), (Indices{3, 2, 1}));
  EXPECT_TRUE(says(refused({{"", "B"}, {"", "G"}, {"", "R"}, {"", "id"}}), "`channel`"));
}

TEST(ExrChannels, TwoCandidatesAreRefusedAndOneCanBeChosen) {
  EXPECT_TRUE(says(refused({{"left", "Z"}, {"right", "Z"}}), "left:Z, right:Z"));
  EXPECT_EQ(chosen({{"left", "Z"}, {"right", "Z"}}, "right:Z"), (Indices{1}));
  EXPECT_TRUE(says(refused({{"left", "Z"}, {"right", "Z"}}, "Z"), "several parts"));
  EXPECT_TRUE(says(refused({{"", "Z"}}, "\x1b[31m"), "'\\x1b[31m'"));
}

}  // namespace
}  // namespace vpm
