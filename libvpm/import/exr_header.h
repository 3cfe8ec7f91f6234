// Checks the header of an OpenEXR file before OpenEXR sees it, which takes memory for what a header
// declares before it reads it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vpm {

// Returns the number of pixels from `low` to `high`, both included; 0 if there is none.
inline std::uint64_t extent(std::int64_t low, std::int64_t high) {
  return high < low ? 0 : static_cast<std::uint64_t>(high - low) + 1;
}

// Throws std::runtime_error if an attribute is longer than the file or than its value, if the image
// cannot have its rows or tiles in the file, or if reading it would take more memory than a file of
// this size may ask for (most_memory). Passes over what OpenEXR itself refuses.
void check_exr_header(std::span<const std::byte> bytes);

}  // namespace vpm
