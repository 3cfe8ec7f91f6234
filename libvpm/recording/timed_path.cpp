#include "libvpm/recording/timed_path.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/core/pose.h"
#include "libvpm/recording/median_interval.h"

namespace vpm {

TimedPath::TimedPath(PoseReader& reader) {
  while (const std::optional<Pose> pose = reader.next()) {
    if (reader.time()) {
      times_.push_back(*reader.time());
      if (!std::isfinite(times_.back())) refuse("the time is not finite", reader.place());
      if (times_.size() > 1 && !(times_.back() > times_[times_.size() - 2]))
        refuse("times must ascend", reader.place());
    }
    poses_.push_back(*pose);
    if (!times_.empty() && times_.size() != poses_.size())
      refuse("either every pose has a time or none", reader.place());
  }
  if (poses_.empty()) reader.refuse_empty();
}

Pose TimedPath::at(double time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  if (after == times_.begin()) return poses_.front();
  if (after == times_.end()) return poses_.back();
  const std::size_t next = static_cast<std::size_t>(after - times_.begin());
  const Pose &from = poses_[next - 1], &to = poses_[next];
  const double part = (time - times_[next - 1]) / (times_[next] - times_[next - 1]);
  return {interpolate(from.rotation, to.rotation, part),
          from.translation + part * (to.translation - from.translation)};
}

std::optional<PoseGap> TimedPath::improbable_gap() const {
  constexpr double kShortest = 0.5, kMedians = 10;
  PoseGap longest;
  for (std::size_t k = 1; k < times_.size(); ++k)
    if (times_[k] - times_[k - 1] > longest.end - longest.start)
      longest = {times_[k - 1], times_[k]};
  const double length = longest.end - longest.start;
  if (length > kShortest && length > kMedians * median_interval(times_)) return longest;
  return std::nullopt;
}

SampledPath::SampledPath(TimedPath path, double rate) : path_(std::move(path)), rate_(rate) {
  constexpr double kMaxSteps = 1e9;
  const double steps = path_.has_times()
                           ? std::floor((path_.end() - path_.start()) * rate * (1 + 1e-12)) + 1
                           : static_cast<double>(path_.poses().size());
  if (!(steps <= kMaxSteps))
    refuse("the path is longer than 10^9 steps at this rate", {}, "are its times seconds?");
  steps_ = static_cast<std::size_t>(steps);
}

Pose SampledPath::pose(std::size_t step) const {
  return path_.has_times() ? path_.at(path_.start() + time(step)) : path_.poses()[step];
}

}  // namespace vpm
