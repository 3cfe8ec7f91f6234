// Order statistics of measured samples, and the clock that takes them.
#pragma once

#include <vector>

namespace vpm::bench {

// Return the CPU time that this thread, or all threads of the process, have used, s: other
// processes do not add to it.
double thread_seconds();
double process_seconds();

struct Spread {
  double median = 0, quartile1 = 0, quartile3 = 0, min = 0, max = 0;
};

// Returns the quartiles, interpolated between neighbouring samples. `samples` must not be empty.
Spread spread_of(std::vector<double> samples);

// Collects errors: their mean and their worst.
class MeanAndWorst {
 public:
  void add(double value);
  double mean() const { return count_ > 0 ? sum_ / count_ : 0; }
  double worst() const { return worst_; }
  int count() const { return count_; }

 private:
  double sum_ = 0, worst_ = 0;
  int count_ = 0;
};

}  // namespace vpm::bench
