#include <gtest/gtest.h>

#include "libvpm/import/depth_files.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

const std::vector<std::uint16_t> kValues{0, 1, 255, 256, 1000, 65535};

std::string refused(const std::string& file) {
  return test::refusal([&] { parse_png_depth(bytes_of(file), "file"); });
}

TEST(PngDepth, GivesTheValues) {
  for (const bool interlaced : {false, true}) {
    const std::string file = make_png(3, 2, 16, kValues, interlaced);
    const RawDepth image = parse_png_depth(bytes_of(file), "file");
    EXPECT_EQ(image.width, 3U);
    EXPECT_EQ(image.height, 2U);
    EXPECT_EQ(image.values, (std::vector<float>{0, 1, 255, 256, 1000, 65535}));
    EXPECT_EQ(image.usual_units_per_metre(), 1000);
  }
}

TEST(PngDepth, RefusesOtherImages) {
  EXPECT_TRUE(says(refused(make_png(3, 2, 8, kValues)), "16 bits"));
  EXPECT_TRUE(says(refused("\x89PNG\r\n\x1a\n and then nothing"), "file: not a sound PNG"));
}

TEST(PngDepth, RefusesSizesThatTheFileCannotHold) {
  std::string file = make_png(3, 2, 16, kValues);
  file.replace(16, 8, std::string("\x00\x00\x20\x00\x00\x00\x20\x00", 8));  // 8192 x 8192
  // Refuses without taking memory; libpng notices the wrong checksum of the header.
  EXPECT_NE(refused(file), "");
  const std::vector<std::uint16_t> row(100000);
  EXPECT_EQ(refused(make_png(100000, 1, 16, row)), "");
}

TEST(PngDepth, DamageIsRefused) {
  expect_damage_is_refused(make_png(3, 2, 16, kValues), 1000,
                           [](auto bytes) { parse_png_depth(bytes, "file"); });
}

}  // namespace
}  // namespace vpm
