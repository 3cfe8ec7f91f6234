// The usual time from one record to the next.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "libvpm/core/median.h"

namespace vpm {

// Returns the median of the differences from one of the ascending times to the next, s; infinity
// for less than two times.
inline double median_interval(const std::vector<double>& times) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < times.size(); ++k) intervals.push_back(times[k] - times[k - 1]);
  if (intervals.empty()) return HUGE_VAL;
  return median(intervals);
}

}  // namespace vpm
