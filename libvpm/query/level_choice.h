// Which level of a tool model to query: the coarsest that is accurate enough, the finest that is
// fast enough.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "libvpm/model/tool_model.h"

namespace vpm {

// Index of the coarsest level whose worst calibrated error is at most `max_error` (a fraction of
// the tool's volume). Errors: invalid_argument for an error that is no fraction; refused for a
// model without a calibration, with one level only, or none of whose levels is that accurate.
std::size_t coarsest_level_within(const ToolModel& tool, double max_error);

// The finest level that keeps a deadline, from the times of queries. Knows no clock: the caller
// measures. Feed it and it steps down before a deadline is missed, and up again when there is room.
class DeadlineLevel {
 public:
  // `probed` holds the time that each level needs in the midst of a contact, coarsest first;
  // `deadline` in the same unit, positive. Levels after `finest` are never taken.
  DeadlineLevel(std::vector<double> probed, double deadline, std::size_t finest);

  std::size_t level() const { return level_; }
  bool keeps() const;  // false: even the coarsest level is expected to miss the deadline

  // How long the last query took, at level().
  void took(double time);

 private:
  // Part of the deadline that the expected time may use; the rest is for what poses and machine
  // add unforeseen.
  static constexpr double kMargin = 0.8;
  // A lone slow query says nothing; the second slowest of this many does.
  static constexpr std::size_t kRecent = 64;

  double slowness() const;
  void choose();

  std::vector<double> probed_;
  double deadline_;
  std::size_t finest_, level_ = 0, next_ = 0;
  std::array<double, kRecent> recent_{};  // time taken / time probed
};

}  // namespace vpm
