#include "libvpm/view/packed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <string_view>

namespace vpm::view {
namespace {

std::string base64_of(std::string_view text) {
  return base64(std::as_bytes(std::span(text)));
}

std::vector<std::uint8_t> decoded(const std::string& text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(kDigits.find(c));
    if ((count += 6) >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
  }
  return bytes;
}

// The vectors of RFC 4648, section 10.
TEST(Packed, Base64IsThatOfTheStandard) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64_of("\xFB\xFF\xBF"), "+/+/");
}

TEST(Packed, ArraysLieLittleEndian) {
  const std::vector<std::uint32_t> values{1, 0x01020304};
  const Json json = packed(std::span<const std::uint32_t>(values));
  EXPECT_EQ(json["type"], "u32");
  EXPECT_EQ(decoded(json["data"]), (std::vector<std::uint8_t>{1, 0, 0, 0, 4, 3, 2, 1}));
}

TEST(Packed, PositionsAreOffByHalfAStepOfTheirBox) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> along(-3, 5);
  std::vector<Vec3> positions;
  for (int k = 0; k < 200; ++k) positions.push_back({along(random), 100 + along(random), 7});
  const Json json = packed_positions(positions);
  const std::vector<std::uint8_t> bytes = decoded(json["steps"]["data"]);
  ASSERT_EQ(bytes.size(), 6 * positions.size());
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const double truth[3] = {positions[k].x, positions[k].y, positions[k].z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::uint16_t step = 0;
      std::memcpy(&step, &bytes[6 * k + 2 * axis], sizeof step);
      const double size = json["size"][axis], low = json["low"][axis];
      EXPECT_NEAR(low + size * step / 65535, truth[axis], 0.5 * size / 65535 + 1e-12);
    }
  }
}

TEST(Packed, NoPositionsAreAnEmptyArray) {
  EXPECT_EQ(packed_positions({})["steps"]["data"], "");
}

// As decode.js reads them.
Vec3 normal_of(std::uint8_t a, std::uint8_t b) {
  if (a == 0) return {};
  double x = (a - 128) / 127.0, y = (b - 128) / 127.0;
  const double z = 1 - std::abs(x) - std::abs(y);
  if (z < 0) {
    const double folded = (1 - std::abs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::abs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  return normalized_or_zero({x, y, z});
}

TEST(Packed, NormalsAreOffByADegreeAtMost) {
  std::mt19937 random(2);
  std::normal_distribution<double> along;
  std::vector<Vec3f> normals{{}, {0, 0, -1}, {-1, 0, 0}, {0, 1, 0}};
  for (int k = 0; k < 2000; ++k)
    normals.push_back(narrow(normalized_or_zero({along(random), along(random), along(random)})));
  const std::vector<std::uint8_t> bytes = decoded(packed_normals(normals)["data"]);
  ASSERT_EQ(bytes.size(), 2 * normals.size());
  EXPECT_EQ(normal_of(bytes[0], bytes[1]), Vec3{});
  for (std::size_t k = 1; k < normals.size(); ++k)
    EXPECT_GT(dot(normal_of(bytes[2 * k], bytes[2 * k + 1]), widen(normals[k])), std::cos(0.0175));
}

TEST(Packed, EachRowOfBitsBeginsWithAByte) {
  std::vector<std::uint8_t> bits;
  append_bits(std::vector<std::uint8_t>{1, 2, 3, 0, 2}, bits);
  append_bits(std::vector<std::uint8_t>{3}, bits);
  EXPECT_EQ(bits, (std::vector<std::uint8_t>{0b00111001, 0b10, 0b11}));
}

}  // namespace
}  // namespace vpm::view
