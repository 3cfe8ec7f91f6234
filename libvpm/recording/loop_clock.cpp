#include "libvpm/recording/loop_clock.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace vpm {
namespace {

// Time by which a sleeping thread may wake late; the loop spins for the last part of a wait.
constexpr std::chrono::microseconds kWakeUp{150};

}  // namespace

Durations::Durations(std::vector<double> seconds) : sorted_(std::move(seconds)) {
  std::sort(sorted_.begin(), sorted_.end());
}

double Durations::quantile(double part) const {
  const double rank = std::ceil(part * static_cast<double>(sorted_.size()));
  return sorted_[static_cast<std::size_t>(std::max(rank - 1, 0.0))];
}

double Durations::mean() const {
  double sum = 0;
  for (const double s : sorted_) sum += s;
  return sum / static_cast<double>(sorted_.size());
}

double Durations::deviation() const {
  const double middle = mean();
  double sum = 0;
  for (const double s : sorted_) sum += (s - middle) * (s - middle);
  return std::sqrt(sum / static_cast<double>(sorted_.size()));
}

std::size_t Durations::longer_than(double seconds) const {
  return static_cast<std::size_t>(sorted_.end() -
                                  std::upper_bound(sorted_.begin(), sorted_.end(), seconds));
}

LoopClock::LoopClock(double rate, bool realtime)
    : rate_(rate), realtime_(realtime), start_(Clock::now()), from_(start_) {}

void LoopClock::begin_step() {
  if (!realtime_) {
    from_ = Clock::now();
    return;
  }
  const std::chrono::duration<double> due(static_cast<double>(latencies_.size()) / rate_);
  from_ = start_ + std::chrono::duration_cast<Clock::duration>(due);
  std::this_thread::sleep_until(from_ - kWakeUp);
  auto now = Clock::now();
  while (now < from_) now = Clock::now();
  delays_.push_back(std::chrono::duration<double>(now - from_).count());
}

void LoopClock::end_step() {
  latencies_.push_back(std::chrono::duration<double>(Clock::now() - from_).count());
}

double LoopClock::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

}  // namespace vpm
