// Recorded motions between their poses.
#pragma once

#include <utility>
#include <vector>

#include "libvpm/recording/pose_reader.h"

namespace vpm {

// All poses of a reader, with their times where they have them.
class TimedPath {
 public:
  // Where poses have times these must ascend. Throws Error(refused): no pose, times that do not
  // ascend or that only some have, and what the reader throws.
  explicit TimedPath(PoseReader& reader);
  // As many times, ascending, as poses, or none; at least one pose.
  TimedPath(std::vector<double> times, std::vector<Pose> poses)
      : times_(std::move(times)), poses_(std::move(poses)) {}

  bool has_times() const { return !times_.empty(); }
  double start() const { return times_.front(); }  // s, of paths with times
  double end() const { return times_.back(); }
  const std::vector<Pose>& poses() const { return poses_; }

  // Of paths with times: on the shortest turn and the straight line between two poses; the first
  // before, the last after all of them.
  Pose at(double time) const;

 private:
  std::vector<double> times_;  // empty where poses have none
  std::vector<Pose> poses_;
};

// A path sampled at the rate of a loop.
class SampledPath {
 public:
  // `rate`: steps per second, from the first pose to the last; of a path without times each pose is
  // a step. Throws Error(refused) for more than 10^9 steps.
  SampledPath(TimedPath path, double rate);

  std::size_t steps() const { return steps_; }
  double time(std::size_t step) const { return static_cast<double>(step) / rate_; }  // from 0
  Pose pose(std::size_t step) const;
  const TimedPath& path() const { return path_; }

 private:
  TimedPath path_;
  double rate_;
  std::size_t steps_;
};

}  // namespace vpm
