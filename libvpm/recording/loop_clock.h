// Paces the steps of a loop, in real time at its rate or as fast as it goes, and records times.
#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

namespace vpm {

// Order statistics of durations in seconds. A quantile is the smallest recorded duration that at
// least this part of all does not exceed.
class Durations {
 public:
  explicit Durations(std::vector<double> seconds);  // needs at least one
  double quantile(double part) const;
  double mean() const;
  // Returns the standard deviation.
  double deviation() const;
  std::size_t longer_than(double seconds) const;
  std::size_t size() const { return sorted_.size(); }

 private:
  std::vector<double> sorted_;
};

class LoopClock {
 public:
  // `rate` in steps per second. If `realtime`, begin_step() waits until the step is due. The first
  // step is due now.
  LoopClock(double rate, bool realtime);

  void begin_step();
  void end_step();

  // Returns the latency of each step in seconds: until its end, from when it was due (real time) or
  // from when it began.
  const std::vector<double>& latencies() const { return latencies_; }
  // Returns how late each step of a real-time loop began, in seconds.
  const std::vector<double>& delays() const { return delays_; }
  // Returns the seconds since the first step was due.
  double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;

  double rate_;
  bool realtime_;
  Clock::time_point start_, from_;
  std::vector<double> latencies_, delays_;
};

}  // namespace vpm
