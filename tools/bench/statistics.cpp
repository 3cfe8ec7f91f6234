#include "tools/bench/statistics.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace vpm::bench {

namespace {

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double thread_seconds() {
  return seconds_of(CLOCK_THREAD_CPUTIME_ID);
}

double process_seconds() {
  return seconds_of(CLOCK_PROCESS_CPUTIME_ID);
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
