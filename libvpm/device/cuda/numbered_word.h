// Words that host and device leave for each other in the host's memory: each has the number of its
// query or image above it, so none must wait for another on its way over the bus.
#pragma once

#include <cstdint>

#include "libvpm/core/host_device.h"

namespace vpm::cuda {

using NumberedWord = std::uint64_t;

VPM_HD constexpr NumberedWord numbered(unsigned number, std::uint32_t value) {
  return NumberedWord{number} << 32 | value;
}
VPM_HD constexpr unsigned number_of(NumberedWord word) {
  return static_cast<unsigned>(word >> 32);
}
VPM_HD constexpr std::uint32_t value_of(NumberedWord word) {
  return static_cast<std::uint32_t>(word);
}

// Writes a word to a place, or reads one, while the other side may read or write there.
VPM_HD inline void put(NumberedWord word, NumberedWord& place) {
  *static_cast<volatile NumberedWord*>(&place) = word;
}
VPM_HD inline NumberedWord poll(const NumberedWord& place) {
  return *static_cast<const volatile NumberedWord*>(&place);
}

}  // namespace vpm::cuda
