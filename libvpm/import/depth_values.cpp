#include "libvpm/import/depth_values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/import/remark.h"
#include "libvpm/import/scan_facts.h"

namespace vpm {
namespace {

bool is_value(float value) {
  return value > 0 && value < HUGE_VALF;
}

std::string pixels_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " pixel" : " pixels");
}

// Returns the value with its two bytes exchanged.
std::uint16_t swapped(std::uint16_t bits) {
  return static_cast<std::uint16_t>((bits << 8) | (bits >> 8));
}

// Returns the median of the measured values, with the two bytes of each exchanged if `swaps`; 0 if
// nothing was measured.
float median_of(std::span<const float> values, bool swaps) {
  std::vector<float> measured;
  for (const float value : values) {
    if (!is_value(value) || value == 65535) continue;
    measured.push_back(swaps ? swapped(static_cast<std::uint16_t>(value)) : value);
  }
  if (measured.empty()) return 0;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return *middle;
}

// True if there are so many different values that what they have in common is no chance: the order
// of their bytes, or a number that divides them.
bool has_many_values(std::span<const float> values) {
  constexpr std::ptrdiff_t kMany = 32;
  std::vector<bool> found(1U << 16);
  for (const float value : values)
    if (is_value(value)) found[static_cast<std::uint16_t>(value)] = true;
  return std::count(found.begin(), found.end(), true) >= kMany;
}

constexpr float kAbove8Bits = 256;  // 8-bit values are smaller

// True if the lower byte of one value in a hundred is not 0. Otherwise the values may be 8-bit
// ones, times 256.
bool have_low_bytes(std::span<const float> values) {
  constexpr std::size_t kSome = 100;
  std::size_t measured = 0, low = 0;
  for (const float value : values) {
    if (!is_value(value) || value == 65535) continue;
    ++measured;
    low += static_cast<std::uint16_t>(value) % 256 != 0;
  }
  return kSome * low > measured;
}

// Returns the different values of 16 bits, the smallest first, but for the marker 65535.
std::vector<double> different_values(std::span<const float> values) {
  constexpr double kMarker = 65535;
  std::vector<double> different;
  for (const float value : values)
    if (is_value(value) && value < kMarker) different.push_back(value);
  std::ranges::sort(different);
  different.erase(std::unique(different.begin(), different.end()), different.end());
  return different;
}

constexpr double kLevels = 255;       // that 8 bits have, beside 0
constexpr std::size_t kFewTell = 32;  // so many different values are on one scale by no chance
constexpr double kWideStep = 8;       // units; any value is near a multiple of narrower steps
constexpr double kRounding = 1;       // units by which a program may have rounded a level

// Returns the step of which all values are multiples, up to the 255th, if that is no step of a
// sensor: not a whole number of units, or one of 5 cm or more. Returns 0 if there is none.
double even_step(std::span<const double> values, double units_per_metre) {
  constexpr double kCoarse = 0.05;  // m
  for (double top = kFewTell; top <= kLevels; ++top) {
    const double step = values.back() / top, whole = std::round(step);
    const auto is_multiple = [&](double of, double rounding) {
      return [=](double v) { return std::abs(v - std::round(v / of) * of) <= rounding; };
    };
    if (step < kWideStep) return 0;
    if (!std::ranges::all_of(values, is_multiple(step, kRounding))) continue;
    const bool is_whole = std::ranges::all_of(values, is_multiple(whole, 0));
    return !is_whole ? step : whole >= kCoarse * units_per_metre ? whole : 0;
  }
  return 0;
}

// Returns the factor from each level to the next, if all values are on such a scale of at most 255
// steps. Returns 0 if there is none. Small values do not tell, since rounding hides their steps.
double even_factor(std::span<const double> values) {
  constexpr double kSmall = 256;            // units
  constexpr double kTells = 2 * kWideStep;  // units; a quarter of narrower steps is rounding
  const auto from =
      static_cast<std::size_t>(std::ranges::lower_bound(values, kSmall) - values.begin());
  const std::span<const double> large = values.subspan(from);
  if (large.size() < kFewTell) return 0;
  const double range = std::log(large.back() / large.front());
  for (double steps = kFewTell; steps < kLevels; ++steps) {
    const double step = range / steps;
    std::size_t telling = 0;
    const bool is_scale = std::ranges::all_of(large, [&](double v) {
      telling += v * step >= kTells;
      const double level = std::round(std::log(large.back() / v) / step);
      return std::abs(v - large.back() * std::exp(-level * step)) <= kRounding + v * step / 4;
    });
    if (is_scale && telling >= kFewTell) return std::exp(step);
  }
  return 0;
}

// Returns a warning about values on a scale that 8 bits have once they are spread to 16, evenly or
// by a logarithm.
Remarks eight_bit_suspicion(std::span<const float> values,
                            const std::optional<double>& units_per_metre) {
  constexpr double kUsual = 1000;  // units per metre
  const std::vector<double> different = different_values(values);
  if (different.size() < kFewTell || static_cast<double>(different.size()) > kLevels) return {};
  const double step = even_step(different, units_per_metre.value_or(kUsual));
  const double factor = step > 0 ? 0 : even_factor(different);
  if (step == 0 && factor == 0) return {};
  return {
      {true, (step > 0 ? "all values are multiples of " + number_text(std::round(100 * step) / 100)
                       : "each value is " + number_text(std::round(10000 * factor) / 10000) +
                             " times the one below") +
                 ", as 8 bits are that were widened to 16; if so, give the image that they "
                 "were made of"}};
}

// True if the exchanged bytes give millimetres that sensors reach, and the values are beyond them.
bool are_depths_only_if_swapped(std::span<const float> values) {
  constexpr float kFarthest = 20000;
  const float exchanged = median_of(values, true);
  return exchanged >= kAbove8Bits && exchanged <= kFarthest && median_of(values, false) > kFarthest;
}

// True if 16-bit values are far smoother with their two bytes exchanged, and surely so.
bool look_swapped(std::span<const float> values, std::size_t width) {
  constexpr double kSmoother = 8;
  constexpr std::size_t kFewestPairs = 100;  // pairs of different values
  constexpr float kMarker = 65535;           // looks the same in either order
  double as_given = 0, as_swapped = 0;
  std::size_t pairs = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const float left = values[i - 1], right = values[i];
    if (i % width == 0 || !is_value(left) || !is_value(right) || left == right) continue;
    if (left == kMarker || right == kMarker) continue;
    as_given += std::abs(static_cast<double>(right) - left);
    as_swapped += std::abs(swapped(static_cast<std::uint16_t>(right)) -
                           swapped(static_cast<std::uint16_t>(left)));
    ++pairs;
  }
  return pairs >= kFewestPairs && as_given > kSmoother * as_swapped &&
         (has_many_values(values) ? have_low_bytes(values) : are_depths_only_if_swapped(values));
}

// Returns what the bits of a value are after a rotation by three to the right.
std::uint16_t rotated(std::uint16_t bits) {
  return static_cast<std::uint16_t>((bits >> 3) | (bits << 13));
}

// True if 2, 3, 5 or 7 divides nearly all values, as it does where a sensor measures in such steps.
bool have_common_step(std::span<const float> values) {
  constexpr std::size_t kFew = 10;  // one value in ten may be none of its multiples
  for (const int step : {2, 3, 5, 7}) {
    std::size_t measured = 0, others = 0;
    for (const float value : values) {
      if (!is_value(value)) continue;
      ++measured;
      others += static_cast<std::uint16_t>(value) % step != 0;
    }
    if (kFew * others < measured) return true;
  }
  return false;
}

// Counts what neighbouring pixels of different values tell of a rotation by three bits.
struct RotationSigns {
  std::size_t pairs = 0;
  std::size_t nearer = 0;   // pairs whose difference is an eighth, or less, once rotated back
  std::size_t crossed = 0;  // pairs of a low and a high value that are close once rotated back
};

RotationSigns rotation_signs(std::span<const float> values, std::size_t width) {
  constexpr float kAcross = 32768;
  constexpr int kNear = 64;
  RotationSigns signs;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const float left = values[i - 1], right = values[i];
    if (i % width == 0 || !is_value(left) || !is_value(right) || left == right) continue;
    if (left > 65534 || right > 65534) continue;
    const int back = std::abs(rotated(static_cast<std::uint16_t>(left)) -
                              rotated(static_cast<std::uint16_t>(right)));
    ++signs.pairs;
    signs.nearer += static_cast<float>(8 * back) <= std::abs(left - right);
    signs.crossed += std::abs(left - right) > kAcross && back < kNear;
  }
  return signs;
}

// Returns the rest of an advice to rotate values back: the median depth that would result, as
// ", which makes that 1.03 m (SUN3D)", in the unit that the user tells, otherwise in millimetres or
// tenths of them. `median` is that of the values rotated back.
std::string rotated_back_text(double median, const std::optional<double>& units_per_metre) {
  constexpr double kRoom = 4, kFarthest = 10;       // m: medians of depth cameras
  constexpr double kUsual = 1000, kTenths = 10000;  // units per metre
  const double there = median / units_per_metre.value_or(kUsual);
  if (units_per_metre || there <= kRoom)
    return ", which makes that " + metres_text(there) + " (SUN3D)";
  return (there > kFarthest
              ? ""
              : ", which makes that " + metres_text(there) + " (SUN3D), or `decode` rotated") +
         std::string(" and `depth_scale` 10000, which make that ") + metres_text(median / kTenths) +
         " (APC)";
}

// Returns a warning if nearly all values may be rotated by three bits. They surely are where
// neighbouring pixels go from the highest values to the lowest. Otherwise they are multiples of 8,
// which a sensor or a program may also have measured in. If there are many different ones, the
// warning tells the depths that they would be; there is none if those would be nearer than depth
// cameras measure, or if the values have steps larger than 8.
Remarks rotation_suspicion(std::span<const float> values, std::size_t width,
                           const std::optional<double>& units_per_metre) {
  constexpr double kNearest = 0.3;  // m: median rotated back
  constexpr double kUsual = 1000;   // units per metre
  constexpr std::size_t kFewestPairs = 64, kFewestCrossed = 8;
  constexpr double kMostPairs = 0.9;
  const RotationSigns signs = rotation_signs(values, width);
  if (signs.pairs < kFewestPairs ||
      static_cast<double>(signs.nearer) < kMostPairs * static_cast<double>(signs.pairs))
    return {};
  std::vector<float> back;
  for (const float value : values) {
    const bool counts = is_value(value) && value <= 65534;
    back.push_back(counts ? rotated(static_cast<std::uint16_t>(value)) : 0);
  }
  const double scale = units_per_metre.value_or(kUsual), median = median_of(back, false);
  const std::string now = metres_text(median_of(values, false) / scale);
  const std::string cure = "give `decode` rotated" + rotated_back_text(median, units_per_metre);
  if (signs.crossed >= kFewestCrossed)
    return {{true, "its values look rotated by three bits: as they are, their median is " + now +
                       "; " + cure}};
  if (median < kNearest * scale || !has_many_values(values) || have_common_step(back)) return {};
  return {{true, "its values are multiples of 8, and their median is " + now +
                     "; if they are rotated by three bits, " + cure}};
}

// Returns a warning about 16-bit values of which one byte is not used, that look widened from 8
// bits, rotated by three, or like a Kinect's raw disparity.
Remarks coding_suspicions(std::span<const float> values, std::size_t width,
                          const std::optional<double>& units_per_metre) {
  constexpr float kLargestDisparity = 2047;  // marks pixels that have no disparity
  if (has_many_values(values) && !have_low_bytes(values)) {
    return {{true,
             "all values are multiples of 256, like those of 8 bits; if their bytes stand in the "
             "other order, give `decode` swapped"}};
  }
  if (Remarks widened = eight_bit_suspicion(values, units_per_metre); !widened.empty())
    return widened;
  if (Remarks rotated = rotation_suspicion(values, width, units_per_metre); !rotated.empty())
    return rotated;
  std::size_t measured = 0, marked = 0;
  float largest = 0;
  for (const float value : values) {
    if (!is_value(value) || value > 65534) continue;
    ++measured;
    largest = std::max(largest, value);
    marked += value == kLargestDisparity;
  }
  if (largest == kLargestDisparity && 100 * marked > measured) {
    return {{true, "no value is above 2047, which " + pixels_text(marked) +
                       " hold, as in the raw disparity of a Kinect (NYU Depth); if so, give "
                       "`decode` disparity"}};
  }
  return {};
}

// The least or the greatest value of an image, and the one next to it.
struct EndOfRange {
  float value = 0, next = 0;  // `next` is 0 if there is no other value
  std::size_t count = 0;      // pixels with the value
};

// Returns the least value, if is_beyond(a, b) is a < b, or the greatest up to `farthest`, if it is
// a > b.
template <class IsBeyond>
EndOfRange end_of(std::span<const float> values, double farthest, const IsBeyond& is_beyond) {
  EndOfRange end;
  for (const float value : values) {
    if (!is_value(value) || value > farthest) continue;
    if (end.value == 0 || is_beyond(value, end.value)) {
      end.next = end.value;
      end.value = value;
      end.count = 0;
    } else if (value != end.value && (end.next == 0 || is_beyond(value, end.next))) {
      end.next = value;
    }
    end.count += value == end.value;
  }
  return end;
}

// Returns a warning if the largest value, of those up to `farthest`, or the smallest one is on many
// pixels and far from all others, like a marker for "nothing there" or the range's end. The
// smallest must be nearer than a camera measures.
Remarks marker_suspicions(std::span<const float> values, double farthest, double units_per_metre) {
  constexpr float kFar = 2, kNear = 10;  // times the next one
  constexpr double kNearest = 0.1;       // m
  constexpr std::size_t kShare = 100;    // at least one pixel in a hundred
  const auto warning = [](const EndOfRange& end, const char* side) {
    const std::string marker = number_text(end.value);
    return Remarks{{true, pixels_text(end.count) + (end.count == 1 ? " holds " : " hold ") +
                              marker + ", and no other is " + side + " " + number_text(end.next) +
                              "; if that marks what was not measured, give `invalid` " + marker}};
  };
  const EndOfRange low = end_of(values, farthest, std::less<>());
  if (low.next > kNear * low.value && low.count * kShare >= values.size() &&
      low.value < kNearest * units_per_metre)
    return warning(low, "below");
  const EndOfRange high = end_of(values, farthest, std::greater<>());
  if (high.next > 0 && high.value >= kFar * high.next && high.count * kShare >= values.size())
    return warning(high, "above");
  return {};
}

// The largest 16-bit integer, the largest half, Blender's background, the largest float.
constexpr std::array kUsualMarkers{65535.0F, 65504.0F, 1e10F, std::numeric_limits<float>::max()};

float decoded(float value, const DepthDecoding& decoding) {
  auto bits = static_cast<std::uint16_t>(value);
  if (decoding.swapped) bits = swapped(bits);
  if (decoding.rotated) bits = rotated(bits);
  if (!decoding.disparity) return bits;
  // Beyond 10 m, disparities of a Kinect tell nothing (toolbox of NYU Depth V2).
  constexpr double kNumerator = 351.3, kAtInfinity = 1092.5, kFarthest = 10;
  const double depth = kNumerator / (kAtInfinity - bits);
  return depth > 0 && depth <= kFarthest ? static_cast<float>(depth) : 0.0F;
}

bool decodes(const DepthDecoding& decoding) {
  return decoding.swapped || decoding.rotated || decoding.disparity;
}

// Exchanges the bytes of values where they surely stand in the wrong order and the user tells none.
// Returns false, with a warning, where the order is doubtful.
bool find_byte_order(std::vector<float>& values, const RawDepth& raw, const DepthReading& reading,
                     Remarks& remarks) {
  if (reading.decoding.swapped || reading.decoding.big_endian) return true;
  const bool is_looked_at = reading.looks_for_mistakes && !decodes(reading.decoding);
  if (!raw.may_be_swapped && !is_looked_at) return true;
  if (!look_swapped(values, raw.width)) {
    if (!raw.may_be_swapped || !is_looked_at || !are_depths_only_if_swapped(values)) return true;
    remarks.push_back({true,
                       "as the standard of PGM says, half of its values are above 20000; if they "
                       "stand with the low byte first, give `decode` swapped"});
    return false;
  }
  if (!raw.may_be_swapped) {
    remarks.push_back(
        {true,
         "neighbouring values differ as if the order of their two bytes were wrong; if so, give "
         "`decode` swapped"});
    return false;
  }
  for (float& value : values) value = decoded(value, {.swapped = true});
  remarks.push_back({false,
                     "its values stand with the low byte first, and are read so; `decode` "
                     "big-endian reads them as the standard of PGM says"});
  return true;
}

// Replaces the values by what they code, as the user tells. Returns true, with a warning, if they
// look coded in a way that the user does not tell.
bool decode(std::vector<float>& values, const RawDepth& raw, const DepthReading& reading,
            const std::string& name, Remarks& remarks) {
  if (!raw.are_16_bit) {
    if (decodes(reading.decoding))
      throw Error(ErrorKind::invalid_argument,
                  "`decode` is for integers of 16 bits, which this image has not", name);
    return false;
  }
  if (reading.decoding.big_endian && !raw.may_be_swapped)
    remarks.push_back({true, "`decode` big-endian is not used: it is no binary PGM"});
  const bool is_in_order = find_byte_order(values, raw, reading, remarks);
  if (decodes(reading.decoding)) {
    for (float& value : values) value = decoded(value, reading.decoding);
    return false;
  }
  if (!is_in_order) return true;
  const Remarks suspicions = reading.looks_for_mistakes
                                 ? coding_suspicions(values, raw.width, reading.units_per_metre)
                                 : Remarks{};
  append(remarks, suspicions);
  return !suspicions.empty();
}

// Sets values that mean "not measured" to 0. Notes the usual ones that it met.
void remove_markers(std::vector<float>& values, const DepthReading& reading, Remarks& remarks) {
  std::vector<float> markers;
  for (const double value : reading.invalid) markers.push_back(static_cast<float>(value));
  const std::size_t told = markers.size();
  if (reading.has_usual_markers)
    markers.insert(markers.end(), kUsualMarkers.begin(), kUsualMarkers.end());
  std::vector<std::size_t> counts(markers.size());
  for (float& value : values) {
    const auto marker = std::find(markers.begin(), markers.end(), value);
    if (marker == markers.end()) continue;
    ++counts[static_cast<std::size_t>(marker - markers.begin())];
    value = 0;
  }
  for (std::size_t k = told; k < markers.size(); ++k) {
    if (counts[k] == 0) continue;
    remarks.push_back(
        {false, std::to_string(counts[k]) + " pixels hold " + number_text(markers[k]) +
                    ", which is taken for \"not measured\"; `invalid` none takes it for a depth"});
  }
}

double ray_length(const Intrinsics& k, double u, double v) {
  const double x = (u - k.cx) / k.fx, y = (v - k.cy) / k.fy;
  return std::sqrt(1 + x * x + y * y);
}

void along_optical_axis(DepthImage& image, const Intrinsics& intrinsics) {
  for (std::uint32_t v = 0; v < image.height; ++v) {
    for (std::uint32_t u = 0; u < image.width; ++u) {
      float& depth = image.depth[image.index(u, v)];
      depth = static_cast<float>(depth / ray_length(intrinsics, u, v));
    }
  }
}

}  // namespace

std::string number_text(double value) {
  char text[32];
  const auto as_float = static_cast<float>(value);
  const auto [end, fault] = double{as_float} == value
                                ? std::to_chars(text, text + sizeof text, as_float)
                                : std::to_chars(text, text + sizeof text, value);
  return {text, end};
}

DepthDecoding decoding_from_text(const std::string& text) {
  DepthDecoding decoding;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (word == "swapped") {
      decoding.swapped = true;
    } else if (word == "big-endian") {
      decoding.big_endian = true;
    } else if (word == "rotated") {
      decoding.rotated = true;
    } else if (word == "disparity") {
      decoding.disparity = true;
    } else {
      throw Error(ErrorKind::invalid_argument,
                  "'" + file::shown(word) + "' is not swapped, big-endian, rotated or disparity",
                  "`decode`");
    }
    at = end + 1;
  }
  if (decoding.swapped && decoding.big_endian)
    throw Error(ErrorKind::invalid_argument,
                "swapped and big-endian exclude each other: leave one of them out", "`decode`");
  return decoding;
}

DepthImage depth_in_metres_of(const RawDepth& raw, const Intrinsics& intrinsics,
                              const DepthReading& reading, const std::string& name,
                              Remarks& remarks, bool* told_coded) {
  append(remarks, raw.remarks);
  if (!reading.units_per_metre) append(remarks, raw.unit_remarks);
  std::vector<float> values = raw.values;
  const bool look_coded = decode(values, raw, reading, name, remarks);
  if (told_coded != nullptr) *told_coded = look_coded;
  remove_markers(values, reading, remarks);
  // Disparities are metres by now.
  const double usual = reading.decoding.disparity ? 1 : raw.usual_units_per_metre();
  const double units_per_metre = reading.units_per_metre.value_or(usual);
  if (reading.looks_for_mistakes && !look_coded)
    append(remarks, marker_suspicions(values, reading.farthest * units_per_metre, units_per_metre));
  DepthImage image{raw.width, raw.height, std::move(values)};
  for (float& depth : image.depth) depth = depth_in_metres(depth, units_per_metre);
  if (reading.along_ray) along_optical_axis(image, intrinsics);
  if (reading.nearest > 0 || reading.farthest < HUGE_VAL) {
    for (float& depth : image.depth)
      if (!(depth >= reading.nearest && depth <= reading.farthest)) depth = 0;
  }
  return image;
}

}  // namespace vpm
