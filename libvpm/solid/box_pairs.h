// Finds which of many boxes meet.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libvpm/core/box.h"

namespace vpm {

// Places of two boxes in their list; first < second.
struct BoxPair {
  std::size_t first, second;
  friend auto operator<=>(const BoxPair&, const BoxPair&) = default;
};

// Returns the pairs of boxes that have a point in common, in ascending order, by sweep and prune
// (Baraff 1992) along the axis along which the boxes' middles vary most. Boxes must be finite.
std::vector<BoxPair> boxes_that_meet(std::span<const Box> boxes);

}  // namespace vpm
