#include "libvpm/recording/frame_schedule.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/recording/median_interval.h"

namespace vpm {
namespace {

// Part of a step by which a frame may come after it and still be seen, since times since 1970 are
// rounded by as much.
constexpr double kRounding = 1e-3;

}  // namespace

double median_interval(const std::vector<RecordedFrame>& frames, std::size_t source) {
  std::vector<double> times;
  for (const RecordedFrame& frame : frames)
    if (frame.source == source) times.push_back(frame.time);
  return median_interval(times);
}

FrameSchedule::FrameSchedule(const Recording& recording, const ScheduleOptions& options)
    : recording_(recording), options_(options), is_over_(recording.frames.empty()) {
  find_gaps();
  if (is_over_) return;
  const double lasts = recording.frames.back().time - recording.frames.front().time;
  if (options.repeat && !(lasts * options.rate >= 1))
    refuse("frames that all come within one step cannot be repeated", {},
           "leave `repeat_frames` out, or give more frames");
  time_ = turn_time_ = recording.frames.front().time;
  if (!options.repeat) return;
  // Skips whole rounds that end before the first step.
  const double round = 2 * lasts, before = options.start - options.latency - time_;
  if (before > 2 * round) time_ = turn_time_ += round * (std::floor(before / round) - 1);
}

void FrameSchedule::find_gaps() {
  const std::vector<RecordedFrame>& frames = recording_.frames;
  gaps_.resize(frames.size());
  std::vector<std::optional<std::size_t>> last(recording_.sources);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    std::optional<std::size_t>& before = last[frames[k].source];
    if (before) gaps_[*before].after = gaps_[k].before = frames[k].time - frames[*before].time;
    before = k;
  }
  for (std::size_t source = 0; source < recording_.sources; ++source)
    usual_intervals_.push_back(median_interval(frames, source));
}

double FrameSchedule::step_of_next() const {
  const double steps = (time_ - options_.start + options_.latency) * options_.rate;
  return std::max(std::ceil(steps - kRounding), 0.0);
}

void FrameSchedule::advance() {
  const std::vector<RecordedFrame>& frames = recording_.frames;
  const bool at_end = frame_ == (backwards_ ? 0 : frames.size() - 1);
  if (at_end && !options_.repeat) {
    is_over_ = true;
    return;
  }
  if (at_end) {
    backwards_ = !backwards_;
    turn_ = frame_;
    turn_time_ = time_;
  }
  const std::size_t next = backwards_ ? frame_ - 1 : frame_ + 1;
  const double interval = backwards_ ? gaps_[next].after : gaps_[next].before;
  time_ = turn_time_ + std::abs(frames[next].time - frames[turn_].time);
  is_late_ = recording_.has_clock && interval > kLateAfter * usual_intervals_[frames[next].source];
  frame_ = next;
}

std::optional<FrameChange> FrameSchedule::next() {
  const double step = is_over_ ? HUGE_VAL : step_of_next();
  if (!(step < static_cast<double>(options_.steps))) return std::nullopt;
  FrameChange change{static_cast<std::size_t>(step), {}, is_late_};
  while (!is_over_ && step_of_next() == step) {
    change.frames.push_back(frame_);
    advance();
  }
  return change;
}

}  // namespace vpm
