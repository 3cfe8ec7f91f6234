// Finds medians.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace vpm {

// Returns the median of values, of an even number the upper one; there must be one. Reorders them.
inline double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace vpm
