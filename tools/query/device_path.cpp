#include "tools/query/device_path.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/haptics/rotation_vector.h"

namespace vpm::tools {

DevicePath::DevicePath(PoseReader& reader, double rate) : rate_(rate) {
  double start = 0;
  while (const std::optional<Pose> pose = reader.next()) {
    if (poses_.empty()) start = reader.time().value_or(0);
    if (reader.time()) {
      times_.push_back(*reader.time() - start);
      if (times_.size() > 1 && !(times_.back() > times_[times_.size() - 2]))
        refuse(reader.place() + ": times must ascend");
    }
    poses_.push_back(*pose);
    if (!times_.empty() && times_.size() != poses_.size())
      refuse(reader.place() + ": either every pose has a time or none");
  }
  if (poses_.empty()) refuse(reader.place() + ": no pose in it");
  constexpr double kMostSteps = 1e9;
  const double steps = times_.empty() ? static_cast<double>(poses_.size())
                                      : std::floor(times_.back() * rate * (1 + 1e-12)) + 1;
  if (!(steps <= kMostSteps))
    refuse(reader.place() +
           ": the path is longer than 10^9 steps at this rate; are its times seconds?");
  steps_ = static_cast<std::size_t>(steps);
}

Pose DevicePath::pose(std::size_t step) const {
  if (times_.empty()) return poses_[step];
  const double t = time(step);
  const auto after = std::upper_bound(times_.begin(), times_.end(), t);
  if (after == times_.end()) return poses_.back();
  const std::size_t next = static_cast<std::size_t>(after - times_.begin());
  const Pose &from = poses_[next - 1], &to = poses_[next];
  const double part = (t - times_[next - 1]) / (times_[next] - times_[next - 1]);
  return {interpolate(from.rotation, to.rotation, part),
          from.translation + part * (to.translation - from.translation)};
}

}  // namespace vpm::tools
