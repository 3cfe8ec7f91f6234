// Recorded motions, interpolated between poses.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "libvpm/recording/pose_reader.h"

namespace vpm {

// Time from one pose to the next.
struct PoseGap {
  double start = 0, end = 0;  // s
};

// Tells what becomes of lines that PoseReader::is_undefined(). Skipped ones with a time give no
// pose; without times they keep their place.
enum class UndefinedPoses { refused, skipped };

// All poses of a reader, with their times if they have any, and those of a scene's solids beside
// them.
class TimedPath {
 public:
  // Reads all poses. A line that gives the one before again, with its time, is dropped. Throws
  // Error(refused) if there is no pose, if times do not ascend, if only some poses have one, or
  // have other numbers of solids, and for errors of the reader.
  explicit TimedPath(PoseReader& reader, UndefinedPoses undefined = UndefinedPoses::refused);
  // Needs at least one pose, and as many ascending times (s) or none.
  TimedPath(std::vector<double> times, std::vector<Pose> poses)
      : times_(std::move(times)), poses_(std::move(poses)) {}

  // Makes a path of solids alone: needs as many ascending times as lists, all of one length.
  TimedPath(std::vector<double> times, std::vector<std::vector<Pose>> solids)
      : times_(std::move(times)), poses_(solids.size()), solids_(std::move(solids)) {}

  bool has_times() const { return !times_.empty(); }
  double start() const { return times_.front(); }  // s; needs has_times()
  double end() const { return times_.back(); }
  const std::vector<Pose>& poses() const { return poses_; }
  // Returns the number of lines that were dropped, and of those that were skipped.
  std::size_t doubled() const { return doubled_; }
  std::size_t undefined() const { return undefined_; }
  // True if the k-th pose keeps the place of one that is undefined.
  bool is_undefined(std::size_t k) const;

  // Returns the pose at a time, interpolated along the straight line and the shortest rotation, or
  // the first or last pose outside the path's times. Needs has_times().
  Pose at(double time) const;

  // Returns the number of solids that move with the path, and their poses, mesh to world, beside
  // the k-th pose, or at a time, interpolated as the path is.
  std::size_t solids() const { return solids_.empty() ? 0 : solids_.front().size(); }
  std::vector<Pose> solids_of(std::size_t k) const {
    return solids_.empty() ? std::vector<Pose>{} : solids_[k];
  }
  std::vector<Pose> solids_at(double time) const;
  // Returns the greatest speed, m/s, from one pose to the next of solid k, of a point at most
  // `reach`, m, from its mesh's origin, at times at most `within` from `time`, s. Needs
  // has_times().
  double speed_of_solid(std::size_t k, double time, double within, double reach) const;

  // Returns the longest time without a pose if it is improbable of a sensor: more than half a
  // second, and more than ten times the median.
  std::optional<PoseGap> improbable_gap() const;

 private:
  // Returns the next pose, as the reader does, and skips lines that are undefined.
  std::optional<Pose> next(PoseReader& reader, UndefinedPoses undefined);
  // Adds the pose that was read last.
  void add(const PoseReader& reader, const Pose& pose);
  bool is_last(double time, const Pose& pose, const std::vector<Pose>& solids) const;
  void add_solids(const PoseReader& reader);

  // A place between two poses: at `part` of the way from `from` to the next; 0 at either end.
  struct Place {
    std::size_t from;
    double part;
  };
  Place place_of(double time) const;

  std::vector<double> times_;  // empty if poses have no times
  std::vector<Pose> poses_;
  std::vector<std::vector<Pose>> solids_;  // beside each pose; empty if none move
  std::vector<std::size_t> places_;        // ascending; indices of poses that are undefined
  std::size_t doubled_ = 0, undefined_ = 0;
};

// Path sampled at the rate of a loop.
class SampledPath {
 public:
  // Samples at `rate` steps per second from the first pose to the last; without times each pose is
  // a step. Throws Error(refused) for more than 10^9 steps.
  SampledPath(TimedPath path, double rate);

  std::size_t steps() const { return steps_; }
  // Returns the seconds from the first step to this one.
  double time(std::size_t step) const { return static_cast<double>(step) / rate_; }
  Pose pose(std::size_t step) const;
  // Returns the poses of the solids that move with the path; none if none do.
  std::vector<Pose> solids(std::size_t step) const;
  const TimedPath& path() const { return path_; }

 private:
  TimedPath path_;
  double rate_;
  std::size_t steps_;
};

}  // namespace vpm
