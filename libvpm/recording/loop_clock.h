// Times of the steps of a loop: by the clock at its rate, or as fast as it goes.
#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

namespace vpm {

// Order statistics of seconds. Quantiles are of those that occurred: at least this part is not
// longer.
class Durations {
 public:
  explicit Durations(std::vector<double> seconds);  // at least one
  double quantile(double part) const;
  double mean() const;
  double deviation() const;  // standard deviation
  std::size_t longer_than(double seconds) const;
  std::size_t size() const { return sorted_.size(); }

 private:
  std::vector<double> sorted_;
};

class LoopClock {
 public:
  // `rate`: steps per second; `realtime`: each step waits until it is due. The first is due now.
  LoopClock(double rate, bool realtime);

  void begin_step();
  void end_step();

  // s, of each step: until its end, from when it was due (real time) or from its beginning.
  const std::vector<double>& latencies() const { return latencies_; }
  // s, of each step in real time: how long after it was due it began.
  const std::vector<double>& delays() const { return delays_; }
  double seconds() const;  // since the first step was due

 private:
  using Clock = std::chrono::steady_clock;

  double rate_;
  bool realtime_;
  Clock::time_point start_, from_;
  std::vector<double> latencies_, delays_;
};

}  // namespace vpm
