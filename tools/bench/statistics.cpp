#include "tools/bench/statistics.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace vpm::bench {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Spread spread_of(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  const auto at = [&](double fraction) {
    const double place = fraction * static_cast<double>(samples.size() - 1);
    const auto low = static_cast<std::size_t>(place);
    const std::size_t high = std::min(low + 1, samples.size() - 1);
    return samples[low] + (place - std::floor(place)) * (samples[high] - samples[low]);
  };
  return {at(0.5), at(0.25), at(0.75), samples.front(), samples.back()};
}

void MeanAndWorst::add(double value) {
  sum_ += value;
  ++count_;
  // Lets NaN count as the worst.
  if (std::isnan(value) || value > worst_) worst_ = value;
}

}  // namespace vpm::bench
