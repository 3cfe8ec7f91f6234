#include "libvpm/import/depth_suspicions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace vpm {
namespace {

bool is_value(float value) {
  return value > 0 && value < HUGE_VALF;
}

std::string pixels_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " pixel" : " pixels");
}

}  // namespace

std::uint16_t swapped(std::uint16_t bits) {
  return static_cast<std::uint16_t>((bits << 8) | (bits >> 8));
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

bool look_swapped(std::span<const float> values, std::size_t width) {
  constexpr double kSmoother = 8;
  constexpr std::size_t kFewestPairs = 100;  // of different values
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
  return pairs >= kFewestPairs && as_given > kSmoother * as_swapped;
}

Remarks coding_suspicions(std::span<const float> values) {
  constexpr std::size_t kFewestSteps = 64;   // distinct multiples of 8
  constexpr float kLargestDisparity = 2047;  // marks pixels without any
  std::size_t measured = 0, multiples = 0, marked = 0;
  float largest = 0;
  std::vector<bool> steps(1U << 13);
  for (const float value : values) {
    if (!is_value(value) || value > 65534) continue;
    const auto bits = static_cast<std::uint16_t>(value);
    ++measured;
    largest = std::max(largest, value);
    marked += value == kLargestDisparity;
    if (bits % 8 != 0) continue;
    ++multiples;
    steps[bits / 8] = true;
  }
  const auto distinct = static_cast<std::size_t>(std::count(steps.begin(), steps.end(), true));
  if (multiples == measured && distinct >= kFewestSteps) {
    return {{true,
             "all values are multiples of 8, as if they were rotated by three bits (SUN3D, APC), "
             "which makes depths 8 times too large; if so, give `decode` rotated"}};
  }
  if (largest == kLargestDisparity && 100 * marked > measured) {
    return {{true, "no value is above 2047, which " + pixels_text(marked) +
                       " hold, as in the raw disparity of a Kinect (NYU Depth); if so, give "
                       "`decode` disparity"}};
  }
  return {};
}

Remarks marker_suspicions(std::span<const float> values, double farthest) {
  constexpr float kFar = 2;            // times the next smaller value
  constexpr std::size_t kShare = 100;  // one pixel of so many
  float largest = 0, next = 0;
  std::size_t count = 0;
  for (const float value : values) {
    if (!is_value(value) || value < next || value > farthest) continue;
    if (value > largest) {
      next = largest;
      largest = value;
      count = 0;
    } else if (value < largest) {
      next = value;
    }
    count += value == largest;
  }
  if (next == 0 || largest < kFar * next || count * kShare < values.size()) return {};
  const std::string marker = number_text(largest);
  return {{true, pixels_text(count) + " hold " + marker + ", and no other is above " +
                     number_text(next) + "; if that marks what was not measured, give `invalid` " +
                     marker}};
}

}  // namespace vpm
