// Which frame each step of a loop sees: decided by the times of the data alone, never by a clock.
#pragma once

#include <optional>
#include <vector>

#include "libvpm/recording/recording.h"

namespace vpm {

struct ScheduleOptions {
  double rate = 1000;     // steps per second
  std::size_t steps = 0;  // of the loop
  double start = 0;       // s: the time of step 0 on the recording's clock
  double latency = 0;     // s from a frame's time until a step can see it
  bool repeat = false;    // from the last frame back to the first and forth again, without end
};

// Frames that come between two steps.
struct FrameChange {
  std::size_t step = 0;             // the first that can see them
  std::vector<std::size_t> frames;  // of the recording, in the order of their coming
  bool is_late = false;             // the first of them is
};

// Gives the changes of a loop one after the other.
class FrameSchedule {
 public:
  // A frame that comes more than this many usual intervals (their median) after the one before is
  // late. Numbered frames are never late, but missing.
  static constexpr double kLateAfter = 1.5;

  // `recording` must outlive the schedule. Throws Error(refused) where frames that all come within
  // one step are to be repeated.
  FrameSchedule(const Recording& recording, const ScheduleOptions& options);

  // Nothing where no frame comes before the loop ends.
  std::optional<FrameChange> next();

 private:
  double step_of_next() const;
  void advance();

  const Recording& recording_;
  ScheduleOptions options_;
  double usual_interval_ = 0;
  double time_ = 0;        // of the next frame to come
  std::size_t frame_ = 0;  // likewise
  std::size_t turn_ = 0;   // the frame from which it goes one way
  double turn_time_ = 0;
  bool backwards_ = false;
  bool is_over_ = false;
  bool is_late_ = false;  // the next frame
};

}  // namespace vpm
