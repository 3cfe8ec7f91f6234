#include "libvpm/recording/frame_schedule.h"

#include <gtest/gtest.h>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

Recording frames_at(const std::vector<double>& times) {
  Recording recording;
  for (const double time : times) recording.frames.push_back({time, "", {}, false});
  return recording;
}

std::vector<FrameChange> all_of(FrameSchedule schedule) {
  std::vector<FrameChange> changes;
  while (std::optional<FrameChange> change = schedule.next()) changes.push_back(std::move(*change));
  return changes;
}

std::vector<FrameChange> changes_of(const Recording& recording, const ScheduleOptions& options) {
  return all_of(FrameSchedule(recording, options));
}

// Returns the frame that a step sees by definition: the last one that has come.
std::size_t seen_by(std::size_t step, const Recording& recording, const ScheduleOptions& options) {
  const double now = options.start + static_cast<double>(step) / options.rate;
  std::size_t seen = recording.frames.size();
  for (std::size_t k = 0; k < recording.frames.size(); ++k)
    if (recording.frames[k].time + options.latency <= now + 1e-9) seen = k;
  return seen;
}

TEST(FrameSchedule, StepsSeeTheLastFrameThatHasCome) {
  const Recording recording = frames_at({0, 1 / 30., 2 / 30., 0.1, 0.1004, 0.1008, 0.25});
  for (const double latency : {0.0, 0.0125, 0.1}) {
    for (const double rate : {10.0, 333.0, 1000.0}) {
      for (const double start : {-0.02, 0.0, 0.08}) {
        const ScheduleOptions options{rate, 400, start, latency, false};
        const std::vector<FrameChange> changes = changes_of(recording, options);
        std::size_t seen = recording.frames.size();
        auto next = changes.begin();
        for (std::size_t step = 0; step < options.steps; ++step) {
          if (next != changes.end() && next->step == step) seen = (next++)->frames.back();
          ASSERT_EQ(seen, seen_by(step, recording, options))
              << step << ' ' << latency << ' ' << rate << ' ' << start;
        }
      }
    }
  }
}

TEST(FrameSchedule, EveryFrameComesOnceAndInOrder) {
  const Recording recording = frames_at({5, 5.1, 5.1, 5.3, 5.9});
  std::vector<std::size_t> came;
  for (const FrameChange& change : changes_of(recording, {7, 100, 5, 0, false}))
    came.insert(came.end(), change.frames.begin(), change.frames.end());
  EXPECT_EQ(came, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

TEST(FrameSchedule, TimesSince1970AreNotLateByRounding) {
  const double start = 1305031102.160407;
  const Recording recording = frames_at({start, start + 0.033, start + 0.066});
  const std::vector<FrameChange> changes = changes_of(recording, {1000, 100, start, 0, false});
  ASSERT_EQ(changes.size(), 3u);
  EXPECT_EQ(changes[1].step, 33u);
  EXPECT_EQ(changes[2].step, 66u);
}

TEST(FrameSchedule, RepeatsBackAndForth) {
  const Recording recording = frames_at({0, 0.1, 0.3});
  std::vector<std::size_t> steps, frames;
  for (const FrameChange& change : changes_of(recording, {10, 10, 0, 0, true})) {
    steps.push_back(change.step);
    frames.push_back(change.frames.front());
  }
  EXPECT_EQ(steps, (std::vector<std::size_t>{0, 1, 3, 5, 6, 7, 9}));
  EXPECT_EQ(frames, (std::vector<std::size_t>{0, 1, 2, 1, 0, 1, 2}));
  const Recording one = frames_at({0});
  EXPECT_THROW(FrameSchedule(one, {10, 10, 0, 0, true}), Error);
  const Recording short_one = frames_at({0, 1e-9});  // a million frames would come at each step
  EXPECT_THROW(FrameSchedule(short_one, {1000, 10, 0, 0, true}), Error);
}

TEST(FrameSchedule, RoundsThatAreOverBeforeItBeginsAreLeftOut) {
  const Recording recording = frames_at({0, 0.25, 0.5});
  for (const double start : {7.0, 1024.0, 1e6}) {  // whole rounds of a second
    const std::vector<FrameChange> late = changes_of(recording, {8, 32, start, 0, true});
    ASSERT_FALSE(late.empty());
    EXPECT_LT(late[0].frames.size(), 20U);
    const std::vector<FrameChange> early = changes_of(recording, {8, 32, 1, 0, true});
    ASSERT_EQ(late.size(), early.size());
    for (std::size_t k = 0; k < late.size(); ++k) {
      EXPECT_EQ(late[k].step, early[k].step);
      EXPECT_EQ(late[k].frames.back(), early[k].frames.back());
    }
  }
}

TEST(FrameSchedule, AFrameAfterALongGapIsLate) {
  Recording recording = frames_at({0, 0.03, 0.06, 0.12, 0.15});
  std::vector<bool> late;
  for (const FrameChange& change : changes_of(recording, {1000, 1000, 0, 0, false}))
    late.push_back(change.is_late);
  EXPECT_EQ(late, (std::vector<bool>{false, false, false, true, false}));
  recording.has_clock = false;  // a gap is then a missing number
  for (const FrameChange& change : changes_of(recording, {1000, 1000, 0, 0, false}))
    EXPECT_FALSE(change.is_late);
}

// Cameras of different rates: neither the quick one nor the slow one is late for the other's sake.
TEST(FrameSchedule, AFrameOfOneCameraIsLateByItsOwnTimes) {
  const Recording both = joined({frames_at({0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.08, 0.09}),
                                 frames_at({0.001, 0.041, 0.081, 0.201})});
  std::vector<double> late;
  for (const FrameChange& change : changes_of(both, {1000, 1000, 0, 0, false})) {
    ASSERT_EQ(change.frames.size(), 1U);
    if (change.is_late) late.push_back(both.frames[change.frames.front()].time);
  }
  EXPECT_EQ(late, (std::vector<double>{0.08, 0.201}));
}

TEST(FrameSchedule, OfNothingIsNothing) {
  const Recording recording;
  EXPECT_FALSE(FrameSchedule(recording, {1000, 10, 0, 0, true}).next());
}

}  // namespace
}  // namespace vpm
