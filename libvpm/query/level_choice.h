// Chooses the level of a tool model: the coarsest accurate enough, or the finest fast enough.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "libvpm/model/tool_model.h"

namespace vpm {

// Returns the index of the coarsest level whose worst calibrated error is at most `max_error`, a
// fraction of the tool's volume. Throws Error(invalid_argument) for an error outside (0, 1);
// Error(refused) for a model without a calibration, with one level only, or without a level that
// accurate.
std::size_t coarsest_level_within(const ToolModel& tool, double max_error);

// Chooses the finest level that keeps a deadline from the times of queries, which the caller
// measures. Steps down before a deadline is missed, and up again when there is time.
class DeadlineLevel {
 public:
  // `probed` holds the time of each level in the midst of a contact, coarsest first; `deadline` is
  // positive and in the same unit. Levels after `finest` are never taken.
  DeadlineLevel(std::vector<double> probed, double deadline, std::size_t finest);

  std::size_t level() const { return level_; }
  bool keeps() const;  // false if even the coarsest level is expected to miss the deadline

  // Adds the time of the last query, which ran at level().
  void took(double time);

 private:
  // Sets the part of the deadline that the expected time may use. The rest is a reserve.
  static constexpr double kMargin = 0.8;
  // Counts the last queries of which the second slowest counts, since a lone slow one says nothing.
  static constexpr std::size_t kRecent = 64;

  double slowness() const;
  void choose();

  std::vector<double> probed_;
  double deadline_;
  std::size_t finest_, level_ = 0, next_ = 0;
  std::array<double, kRecent> recent_{};  // time taken / time probed
};

}  // namespace vpm
