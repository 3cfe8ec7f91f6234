// Recognises values of depth images that do not mean what they seem to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/import/remark.h"

namespace vpm {

// True if 16-bit values are far smoother with their two bytes exchanged.
bool look_swapped(std::span<const float> values, std::size_t width);

// Returns warnings about 16-bit values that look rotated by three bits, or like a Kinect's raw
// disparity.
Remarks coding_suspicions(std::span<const float> values);

// Returns a warning if the largest value, of those up to `farthest`, is on many pixels and far from
// all others, like a marker for "nothing there" or the range's end.
Remarks marker_suspicions(std::span<const float> values, double farthest);

// Returns the value with its two bytes exchanged.
std::uint16_t swapped(std::uint16_t bits);

// Returns the number as short as "%g" writes it.
std::string number_text(double value);

}  // namespace vpm
