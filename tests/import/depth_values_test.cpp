#include "libvpm/import/depth_values.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

const Intrinsics kCamera{100, 100, 0, 0};

RawDepth image_of(std::vector<float> values, std::uint32_t width, bool is_16_bit) {
  RawDepth raw;
  raw.width = width;
  raw.height = static_cast<std::uint32_t>(values.size()) / width;
  raw.values = std::move(values);
  raw.are_integers = raw.are_16_bit = is_16_bit;
  return raw;
}

// Returns a slope of 16-bit values with steps of one.
std::vector<float> slope(std::size_t count) {
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<float>(1000 + i));
  return values;
}

float swapped(float value) {
  const auto bits = static_cast<std::uint16_t>(value);
  return static_cast<std::uint16_t>((bits << 8) | (bits >> 8));
}

struct Metres {
  std::vector<float> depth;
  Remarks remarks;
};

Metres metres(const RawDepth& raw, const DepthReading& reading = {}) {
  Metres result;
  result.depth = depth_in_metres_of(raw, kCamera, reading, "file", result.remarks).depth;
  return result;
}

TEST(DepthValues, IntegersAreMillimetresAndFloatsMetresUnlessToldOtherwise) {
  EXPECT_EQ(metres(image_of({1000, 0}, 2, true)).depth, (std::vector<float>{1, 0}));
  EXPECT_EQ(metres(image_of({1, -1}, 2, false)).depth, (std::vector<float>{1, 0}));
  EXPECT_EQ(metres(image_of({5000, 0}, 2, true), {.units_per_metre = 5000}).depth[0], 1);
}

TEST(DepthValues, UsualMarkersAreFoundAndSaid) {
  for (const float marker : {65535.F, 65504.F, 1e10F}) {
    const Metres read = metres(image_of({1, marker, 1.5F}, 3, false));
    EXPECT_EQ(read.depth, (std::vector<float>{1, 0, 1.5F}));
    ASSERT_EQ(read.remarks.size(), 1U);
    EXPECT_FALSE(read.remarks[0].is_warning);
    EXPECT_TRUE(says(read.remarks[0].text, "`invalid` none"));
  }
  const Metres kept =
      metres(image_of({60000, 65535, 61000}, 3, true), {.has_usual_markers = false});
  EXPECT_EQ(kept.depth[1], 65.535F);
  EXPECT_TRUE(kept.remarks.empty());
  EXPECT_EQ(metres(image_of({1000, 4095, 65535}, 3, true), {.invalid = {4095}}).depth,
            (std::vector<float>{1, 0, 0}));
}

TEST(DepthValues, AFarValueOnManyPixelsIsSaid) {
  const Metres read = metres(image_of({1, 10, 1.5F, 10}, 4, false));
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_TRUE(says(read.remarks[0].text, "2 pixels hold 10"));
  EXPECT_TRUE(says(read.remarks[0].text, "`invalid` 10"));
  EXPECT_TRUE(metres(image_of({1, 10, 1.5F, 10}, 4, false), {.invalid = {10}}).remarks.empty());
  EXPECT_TRUE(metres(image_of({1, 1, 1, 1}, 4, false)).remarks.empty()) << "a wall";
}

TEST(DepthValues, ANearValueOnManyPixelsIsSaid) {
  const Metres read = metres(image_of({0.01F, 1, 0.01F, 1.5F}, 4, false));
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_TRUE(says(read.remarks[0].text, "2 pixels hold 0.01"));
  EXPECT_TRUE(says(read.remarks[0].text, "`invalid` 0.01"));
  // A flat wall is no marker beside one.
  const Metres flat = metres(image_of({0.001F, 1, 1, 1}, 4, false));
  ASSERT_EQ(flat.remarks.size(), 1U);
  EXPECT_TRUE(says(flat.remarks[0].text, "`invalid` 0.001"));
  EXPECT_TRUE(says(metres(image_of({10, 1000, 1500, 1200}, 4, true)).remarks.at(0).text,
                   "1 pixel holds 10"));
  EXPECT_TRUE(metres(image_of({0.3F, 1, 0.3F, 1.5F}, 4, false)).remarks.empty()) << "a box";
}

TEST(DepthValues, RotatedValuesAreNamedAndRead) {
  std::vector<float> values = slope(200);
  for (float& value : values) value *= 8;
  const Metres read = metres(image_of(values, 200, true));
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_TRUE(says(read.remarks[0].text, "`decode` rotated"));
  const Metres decoded =
      metres(image_of(values, 200, true), {.decoding = decoding_from_text("rotated")});
  EXPECT_EQ(decoded.depth[5], 1.005F);
  EXPECT_TRUE(decoded.remarks.empty());
  EXPECT_EQ(
      metres(image_of({9001 >> 13 | (9001 & 8191) << 3}, 1, true), {.decoding = {.rotated = true}})
          .depth[0],
      9.001F);
}

// Returns depths of a corridor from `near` to `far` in whole units, with a unit or two of noise.
std::vector<float> corridor(int near, int far, std::size_t count) {
  std::vector<float> values;
  for (std::size_t k = 0; k < count; ++k) {
    const double part = static_cast<double>(k % 320) / 320;
    const double depth = near / (1 - part * (1 - static_cast<double>(near) / far));
    values.push_back(std::round(static_cast<float>(depth)) + static_cast<float>(k * 7 % 3));
  }
  return values;
}

std::vector<float> rotated_left(std::vector<float> values) {
  for (float& value : values) {
    const auto bits = static_cast<std::uint32_t>(value);
    value = static_cast<float>((bits << 3 | bits >> 13) & 0xFFFFU);
  }
  return values;
}

TEST(DepthValues, RotatedValuesAreToldByMostOfThemAndByTheirDepths) {
  constexpr std::size_t kCount = 320 * 20;
  struct Row {
    int near, far;
    std::string cure;
  };
  const std::string tenths = "`decode` rotated and `depth_scale` 10000";
  for (const auto& [near, far, cure] : {Row{800, 4000, "`decode` rotated, which makes that 1."},
                                        Row{1500, 9500, "`decode` rotated, which makes that 2."},
                                        Row{4100, 16000, tenths}, Row{5000, 9000, tenths}}) {
    std::vector<float> values = rotated_left(corridor(near, far, kCount));
    for (std::size_t k = 0; k < kCount; k += 50) values[k] = 0;   // not measured
    for (std::size_t k = 7; k < kCount; k += 99) values[k] += 3;  // whatever a few do
    const Metres read = metres(image_of(values, 320, true));
    ASSERT_EQ(read.remarks.size(), 1U) << near;
    EXPECT_TRUE(says(read.remarks[0].text, cure)) << near;
    DepthReading cured{.decoding = {.rotated = true}};
    if (cure == tenths) cured.units_per_metre = 10000;
    EXPECT_TRUE(metres(image_of(values, 320, true), cured).remarks.empty());
  }
  // The unit is told already.
  const Metres told = metres(image_of(rotated_left(corridor(4100, 9000, kCount)), 320, true),
                             {.units_per_metre = 10000});
  ASSERT_EQ(told.remarks.size(), 1U);
  EXPECT_FALSE(told.remarks[0].text.find("depth_scale") < told.remarks[0].text.size());
}

TEST(DepthValues, NearValuesMayBeRotatedAndAreAskedAbout) {
  for (const auto& [near, far] : {std::pair{400, 900}, {500, 800}, {600, 3000}}) {
    const Metres read = metres(image_of(rotated_left(corridor(near, far, 320 * 20)), 320, true));
    ASSERT_EQ(read.remarks.size(), 1U) << near;
    EXPECT_TRUE(
        says(read.remarks[0].text, "if they are rotated by three bits, give `decode` rotated"))
        << read.remarks[0].text;
  }
}

// Of far depths both usual units may be meant.
TEST(DepthValues, RotatedValuesOfTwoUnitsAreAChoice) {
  const Metres read = metres(image_of(rotated_left(corridor(5000, 7500, 320 * 20)), 320, true));
  ASSERT_EQ(read.remarks.size(), 1U);
  for (const char* const part : {"(SUN3D), or ", "`depth_scale` 10000", "(APC)"})
    EXPECT_TRUE(says(read.remarks[0].text, part)) << read.remarks[0].text;
}

TEST(DepthValues, SwappedBytesAreTheOnlyCauseThatIsSaid) {
  std::vector<float> values = corridor(1400, 2000, 320 * 20);
  for (float& value : values) value = swapped(value);
  bool look_coded = false;
  Remarks remarks;
  depth_in_metres_of(image_of(values, 320, true), kCamera, {}, "file", remarks, &look_coded);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_TRUE(says(remarks[0].text, "`decode` swapped"));
  EXPECT_TRUE(look_coded);
}

// Expects the one warning that values were widened from 8 bits.
void expect_widened(const std::vector<float>& values, const DepthReading& reading,
                    const std::string& how) {
  const Metres read = metres(image_of(values, 320, true), reading);
  ASSERT_EQ(read.remarks.size(), 1U) << how;
  EXPECT_TRUE(says(read.remarks[0].text, "8 bits")) << how << ": " << read.remarks[0].text;
}

TEST(DepthValues, EightBitsThatWereWidenedAreSaid) {
  const std::vector<float> bytes = corridor(50, 250, 320 * 20);
  for (const float factor :
       {256.F, 257.F, 255.F, 100.F, 10000 / 255.F, 5000 / 255.F, 60000 / 255.F})
    for (const bool is_rounded : {true, false}) {
      std::vector<float> values = bytes;
      for (float& value : values)
        value = is_rounded ? std::round(factor * value) : std::floor(factor * value);
      expect_widened(values, {}, std::to_string(factor));
    }
  std::vector<float> fine = bytes;  // steps of 255 units of .2 mm
  for (float& value : fine) value *= 255;
  expect_widened(fine, {.units_per_metre = 5000}, "5000");
  for (const auto& [near, far] : {std::pair{1., 10000.}, {100., 10000.}, {300., 20000.}}) {
    std::vector<float> values = bytes;
    for (float& value : values)
      value = static_cast<float>(std::round(near * std::pow(far / near, value / 255.)));
    expect_widened(values, {}, "by a logarithm");
  }
}

TEST(DepthValues, FewValuesAreNotAlwaysOfEightBits) {
  constexpr std::size_t kCount = 320 * 20;
  for (const auto& [near, far] : {std::pair{400, 1200}, {800, 4000}, {2500, 9500}, {5000, 9500}}) {
    // Steps of a Kinect, of a stereo camera with whole disparities, and of centimetres.
    for (const double disparities : {348000., 87000., 70000., 2e6}) {
      std::vector<float> values = corridor(near, far, kCount);
      for (float& value : values)
        value = static_cast<float>(std::round(disparities / std::round(disparities / value)));
      EXPECT_TRUE(metres(image_of(values, 320, true)).remarks.empty())
          << near << " " << disparities;
    }
    for (const double step : {5., 10., 20., 40.}) {
      std::vector<float> values = corridor(near, far, kCount);
      for (float& value : values) value = static_cast<float>(step * std::round(value / step));
      EXPECT_TRUE(metres(image_of(values, 320, true)).remarks.empty()) << near << " " << step;
    }
  }
  std::vector<float> tenths = corridor(800, 4000, kCount);  // of millimetres, in centimetres
  for (float& value : tenths) value = 100 * std::round(value / 10);
  EXPECT_TRUE(metres(image_of(tenths, 320, true), {.units_per_metre = 10000}).remarks.empty());
  std::vector<float> ramp(kCount);  // a program's evenly rising rows
  for (std::size_t k = 0; k < kCount; ++k)
    ramp[k] = std::round(1000 + 4000 / 119.F * static_cast<float>(k / 64));
  EXPECT_TRUE(metres(image_of(ramp, 64, true)).remarks.empty());
}

TEST(DepthValues, MultiplesOfEightAreNotAlwaysRotated) {
  constexpr std::size_t kCount = 320 * 20;
  for (const double step : {8.0, 10.0, 16.0, 24.0, 40.0})
    for (const auto& [near, far] : {std::pair{500, 1200}, {1500, 4000}, {3000, 9500}}) {
      std::vector<float> values = corridor(near, far, kCount);
      for (float& value : values) value = static_cast<float>(step * std::round(value / step));
      const Remarks said = metres(image_of(values, 320, true)).remarks;
      // Steps of 8 far off may be either, which is worded as a choice.
      EXPECT_EQ(said.size(), step == 8 && near == 3000 ? 1U : 0U) << step << " " << near;
      for (const Remark& remark : said) EXPECT_TRUE(says(remark.text, "; if they are rotated"));
    }
  for (const double per_square_metre : {0.0015, 0.003}) {  // steps of a stereo camera, of a Kinect
    std::vector<float> values = corridor(800, 9500, kCount);
    for (float& value : values) {
      const double disparity = std::round(1000 / (per_square_metre * value));
      value = static_cast<float>(8 * std::round(125 / (per_square_metre * disparity)));
    }
    EXPECT_TRUE(metres(image_of(values, 320, true)).remarks.empty()) << per_square_metre;
  }
  // A wall whose few values happen to be multiples of 8.
  std::vector<float> wall(kCount);
  for (std::size_t k = 0; k < kCount; ++k) wall[k] = static_cast<float>(8000 + 8 * (k % 5));
  EXPECT_TRUE(metres(image_of(wall, 320, true)).remarks.empty());
  // Far depths whose values do not tell of a rotation, and eighths of millimetres, told.
  EXPECT_TRUE(metres(image_of(corridor(9000, 60000, kCount), 320, true)).remarks.empty());
  std::vector<float> eighths = corridor(800, 4000, kCount);
  for (float& value : eighths) value *= 8;
  EXPECT_TRUE(metres(image_of(eighths, 320, true), {.units_per_metre = 8000}).remarks.empty());
}

TEST(DepthValues, DisparitiesAreNamedAndRead) {
  const Metres read = metres(image_of({700, 701, 2047}, 3, true));
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_TRUE(says(read.remarks[0].text, "`decode` disparity"));
  const std::vector<float> depth =
      metres(image_of({700, 2047}, 2, true), {.decoding = decoding_from_text("disparity")}).depth;
  EXPECT_NEAR(depth[0], 351.3 / 392.5, 1e-6);
  EXPECT_EQ(depth[1], 0);
  EXPECT_EQ(test::kind_of_fault(
                [] { metres(image_of({1}, 1, false), {.decoding = {.disparity = true}}); }),
            ErrorKind::invalid_argument);
}

TEST(DepthValues, TheOrderOfBytesIsToldByNeighbours) {
  std::vector<float> values = slope(400);
  for (float& value : values) value = swapped(value);
  RawDepth raw = image_of(values, 400, true);
  const Metres warned = metres(raw);
  ASSERT_FALSE(warned.remarks.empty());
  EXPECT_TRUE(says(warned.remarks[0].text, "`decode` swapped"));
  raw.may_be_swapped = true;
  EXPECT_EQ(metres(raw).depth[7], 1.007F);
  EXPECT_EQ(metres(image_of(slope(400), 400, true)).depth[7], 1.007F);
  EXPECT_TRUE(metres(image_of(slope(400), 400, true)).remarks.empty());
}

TEST(DepthValues, NearDepthsTellTheOrderOfBytesToo) {
  std::vector<float> values;
  for (int k = 0; k < 400; ++k) values.push_back(static_cast<float>(150 + k / 3));  // mm
  const auto read = [](std::vector<float> given, bool swaps) {
    if (swaps)
      for (float& value : given) value = swapped(value);
    RawDepth raw = image_of(given, 400, true);
    raw.may_be_swapped = true;
    return metres(raw);
  };
  EXPECT_EQ(read(values, true).depth[9], 0.153F);
  EXPECT_EQ(read(values, false).depth[9], 0.153F);
  // Those of one byte may be 8-bit values, scaled, or stand in the other order.
  for (float& value : values) value = std::min(value, 255.F);
  const Metres doubted = read(values, true);
  ASSERT_EQ(doubted.remarks.size(), 1U);
  EXPECT_TRUE(says(doubted.remarks[0].text, "multiples of 256"));
  EXPECT_TRUE(read(values, false).remarks.empty());
}

TEST(DepthValues, BytesAreExchangedOnlyWhereThatIsSure) {
  // Two depths stand closer with their bytes exchanged; either order may be meant.
  const auto steps = [](float low, float high, bool swaps) {
    std::vector<float> values;
    for (int k = 0; k < 400; ++k) values.push_back(k % 2 == 0 ? low : high);
    if (swaps)
      for (float& value : values) value = swapped(value);
    RawDepth raw = image_of(values, 400, true);
    raw.may_be_swapped = true;
    return raw;
  };
  EXPECT_EQ(metres(steps(1000, 1256, false)).depth[1], 1.256F);
  EXPECT_EQ(metres(steps(1024, 768, false)).depth[1], 0.768F);
  EXPECT_EQ(metres(steps(1000, 800, true)).depth[1], 0.8F);  // as they stand 8 and 59 m
}

TEST(DepthValues, TheOrderOfBytesIsFoundBesideOtherCodingsAndMayBeTold) {
  std::vector<float> values;
  for (int k = 0; k < 400; ++k) values.push_back(swapped(static_cast<float>(600 + k)));
  RawDepth raw = image_of(values, 400, true);
  raw.may_be_swapped = true;
  const float metre = static_cast<float>(351.3 / (1092.5 - 607));
  EXPECT_EQ(metres(raw, {.decoding = decoding_from_text("disparity")}).depth[7], metre);
  EXPECT_EQ(metres(raw, {.decoding = decoding_from_text("swapped,disparity")}).depth[7], metre);
  EXPECT_EQ(metres(raw, {.decoding = decoding_from_text("big-endian")}).depth[7],
            swapped(607) / 1000);
  EXPECT_EQ(metres(raw, {.decoding = decoding_from_text("swapped")}).depth[7], 0.607F);
  raw.may_be_swapped = false;
  const Metres unused =
      metres(image_of(slope(3), 3, true), {.decoding = decoding_from_text("big-endian")});
  ASSERT_EQ(unused.remarks.size(), 1U);
  EXPECT_TRUE(says(unused.remarks[0].text, "not used"));
  EXPECT_EQ(test::kind_of_fault([] { decoding_from_text("swapped,big-endian"); }),
            ErrorKind::invalid_argument);
}

TEST(DepthValues, MarkersDoNotLookSwapped) {
  std::vector<float> values(400, 1000);
  for (std::size_t i = 0; i < values.size(); i += 2) values[i] = 65535;
  const Metres read = metres(image_of(values, 400, true));
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_FALSE(read.remarks[0].is_warning);
}

TEST(DepthValues, DistancesAlongTheRayBecomeDepth) {
  const Metres read = metres(image_of({1, std::sqrt(2.F)}, 2, false), {.along_ray = true});
  EXPECT_EQ(read.depth[0], 1);
  EXPECT_NEAR(read.depth[1], std::sqrt(2) / std::sqrt(1.0001), 1e-6);
}

TEST(DepthValues, ARangeLeavesOutOtherDepths) {
  EXPECT_EQ(metres(image_of({100, 1000, 9000}, 3, true), {.nearest = 0.5, .farthest = 5}).depth,
            (std::vector<float>{0, 1, 0}));
}

TEST(DepthValues, UnknownCodingsAreRefused) {
  EXPECT_EQ(test::kind_of_fault([] { decoding_from_text("rot13"); }), ErrorKind::invalid_argument);
  EXPECT_TRUE(decoding_from_text("swapped,disparity").disparity);
}

}  // namespace
}  // namespace vpm
