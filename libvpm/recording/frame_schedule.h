// Assigns frames to the steps of a loop by the times in the data, never by a clock.
#pragma once

#include <optional>
#include <vector>

#include "libvpm/recording/recording.h"

namespace vpm {

// Returns the median of the times from one frame of a source to its next, s; infinity for less than
// two frames.
double median_interval(const std::vector<RecordedFrame>& frames, std::size_t source = 0);

struct ScheduleOptions {
  double rate = 1000;     // steps per second
  std::size_t steps = 0;  // number of steps of the loop
  double start = 0;       // s; time of step 0 on the recording's clock
  double latency = 0;     // s from a frame's time until a step can see it
  // After the last frame, plays them backwards to the first, then forwards, without end.
  bool repeat = false;
};

// Frames that come between two steps.
struct FrameChange {
  std::size_t step = 0;             // first step that can see them
  std::vector<std::size_t> frames;  // indices in the recording, in order of arrival
  bool is_late = false;             // true if the first of them is late
};

// Returns the changes of a loop one after the other.
class FrameSchedule {
 public:
  // A frame is late if it comes more than this many median intervals of its source after the one
  // before of that. Numbered frames are never late, only missing.
  static constexpr double kLateAfter = 1.5;

  // Keeps a reference to `recording`. Throws Error(refused) if frames are to be repeated that all
  // come within one step.
  FrameSchedule(const Recording& recording, const ScheduleOptions& options);

  // Returns the next change; empty if no frame comes before the loop ends.
  std::optional<FrameChange> next();

 private:
  // Holds the time from a frame to those of its source before and after it, s; 0 without one.
  struct Gaps {
    double before = 0, after = 0;
  };

  void find_gaps();
  double step_of_next() const;
  void advance();

  const Recording& recording_;
  ScheduleOptions options_;
  std::vector<double> usual_intervals_;  // of the sources
  std::vector<Gaps> gaps_;               // of the frames
  double time_ = 0;                      // time of the next frame
  std::size_t frame_ = 0;                // index of the next frame
  std::size_t turn_ = 0;                 // frame at which the direction last changed
  double turn_time_ = 0;
  bool backwards_ = false;
  bool is_over_ = false;
  bool is_late_ = false;  // true if the next frame is late
};

}  // namespace vpm
