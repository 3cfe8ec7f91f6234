#include "libvpm/import/intrinsics_file.h"

#include <gtest/gtest.h>

#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

IntrinsicsFile parse(const std::string& text) {
  return parse_intrinsics(bytes_of(text), "file");
}
std::string refused(const std::string& text) {
  return test::refusal([&] { parse(text); });
}

void expect_camera(const std::string& text, std::uint32_t width = 0, std::uint32_t height = 0) {
  const IntrinsicsFile read = parse(text);
  EXPECT_EQ(read.intrinsics.fx, 525) << text;
  EXPECT_EQ(read.intrinsics.fy, 526) << text;
  EXPECT_EQ(read.intrinsics.cx, 319.5) << text;
  EXPECT_EQ(read.intrinsics.cy, 239.5) << text;
  EXPECT_EQ(read.width, width) << text;
  EXPECT_EQ(read.height, height) << text;
}

TEST(IntrinsicsFile, ReadsText) {
  expect_camera("525 526 319.5 239.5\n");
  expect_camera("# fx fy cx cy\r525,526,+319.5,239.5\r");
  expect_camera("525 0 319.5\r\n0 526 239.5\r\n0 0 1\r\n");
  expect_camera("[[525, 0, 319.5], [0, 526, 239.5], [0, 0, 1]]");
  expect_camera("525 0 319.5 0  0 526 239.5 0  0 0 1 0");
}

TEST(IntrinsicsFile, ReadsJson) {
  expect_camera(
      R"({"width": 640, "height": 480, "fx": 525, "fy": 526, "ppx": 319.5, "ppy": 239.5})", 640,
      480);
  expect_camera(
      R"({"width": 640, "height": 480, "intrinsic_matrix": [525,0,0, 0,526,0, 319.5,239.5,1]})",
      640, 480);
  expect_camera(R"({"K": [525,0,319.5, 0,526,239.5, 0,0,1], "P": [1,0,0,0, 0,1,0,0, 0,0,1,0]})");
  expect_camera(
      R"({"color": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "depth": {"fx": 525, "fy": 526, "cx": 319.5, "cy": 239.5}})");
}

TEST(IntrinsicsFile, RefusesWhatTellsNoCamera) {
  EXPECT_TRUE(says(refused("1 2 3\n"), "3 numbers"));
  EXPECT_TRUE(says(refused(R"({"fx": 525})"), "no camera's intrinsics"));
  EXPECT_TRUE(says(
      refused(
          R"({"left": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "right": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}})"),
      "left, right"));
  EXPECT_TRUE(says(refused("0 526 319.5 239.5"), "focal lengths"));
  EXPECT_TRUE(says(refused(std::string("\x89PNG\0", 5)), "not a text"));
}

TEST(IntrinsicsFile, SaysThatDistortionIsNotUsed) {
  const IntrinsicsFile read =
      parse(R"({"K": [525,0,319.5, 0,526,239.5, 0,0,1], "D": [0.1, 0, 0, 0, 0]})");
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_TRUE(read.remarks[0].is_warning);
}

TEST(IntrinsicsFile, TakesTheRectifiedCameraWhereTheLensDistorts) {
  const std::string k = R"("K": [500,0,300, 0,500,200, 0,0,1], )",
                    p = R"("P": [525,0,319.5,-40, 0,526,239.5,0, 0,0,1,0])";
  expect_camera("{" + k + R"("D": [0.1, 0, 0, 0, 0], )" + p + "}");
  const IntrinsicsFile both = parse("{" + k + R"("D": [0.1, 0, 0, 0, 0], )" + p + "}");
  ASSERT_EQ(both.remarks.size(), 1U);
  EXPECT_TRUE(says(both.remarks[0].text, "its P is used, 525,526,319.5,239.5"));
  const IntrinsicsFile plain = parse("{" + k + R"("D": [0, 0, 0, 0, 0], )" + p + "}");
  EXPECT_EQ(plain.intrinsics.fx, 500);
  ASSERT_EQ(plain.remarks.size(), 1U);
  EXPECT_TRUE(says(plain.remarks[0].text, "its K is used"));
  const IntrinsicsFile empty = parse("{" + k + R"("D": [0.1], "P": [0,0,0,0, 0,0,0,0, 0,0,0,0]})");
  EXPECT_EQ(empty.intrinsics.fx, 500);
}

TEST(IntrinsicsFile, ReadsTheRegionOfInterest) {
  const std::string k = R"({"K": [500,0,300, 0,500,200, 0,0,1], "roi": )";
  const auto region =
      parse(k + R"({"x_offset": 10, "y_offset": 0, "width": 140, "height": 110}})").region;
  ASSERT_TRUE(region);
  EXPECT_EQ(region->left, 10U);
  EXPECT_EQ(region->top, 0U);
  EXPECT_EQ(region->width, 140U);
  EXPECT_FALSE(parse(k + R"({"x_offset": 0, "y_offset": 0, "width": 0, "height": 0}})").region);
}

#ifdef VPM_TESTS_YAML
TEST(IntrinsicsFile, ReadsYaml) {
  expect_camera(
      "camera_name: 'D435'\nxres: 640  # px\nyres: 480\nfx: 525\nfy: 526\ncx: 319.5\ncy: 239.5\n",
      640, 480);
  expect_camera(
      "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [525, 0, 319.5, 0, 526, 239.5, 0, 0, 1]\n"
      "distortion_coefficients:\n  data: [0, 0, 0, 0, 0]\n",
      640, 480);
  expect_camera(
      "%YAML:1.0\n---\nCamera.fx: 525.0\nCamera.fy: 526.0\nCamera.cx: 319.5\nCamera.cy: 239.5\n");
  expect_camera(
      "height: 480\nwidth: 640\nk: [525.0, 0.0, 319.5, 0.0, 526.0, 239.5, 0.0, 0.0, 1.0]\n---\n",
      640, 480);
  EXPECT_TRUE(says(refused("a: [1\n"), "not YAML"));
}
#endif

}  // namespace
}  // namespace vpm
