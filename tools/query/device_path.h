#pragma once

#include <optional>
#include <vector>

#include "tools/query/pose_reader.h"

namespace vpm::tools {

// A recorded path of the haptic device, sampled at the rate of the loop.
class DevicePath {
 public:
  // Reads all poses. Where they have times these must ascend, and the path is interpolated at
  // `rate` (steps per second) from the first to the last; otherwise each pose is a step. Throws
  // Error(refused).
  DevicePath(PoseReader& reader, double rate);

  std::size_t steps() const { return steps_; }
  double time(std::size_t step) const { return static_cast<double>(step) / rate_; }
  Pose pose(std::size_t step) const;

 private:
  double rate_;
  std::vector<double> times_;  // since the first; empty where poses have none
  std::vector<Pose> poses_;
  std::size_t steps_ = 0;
};

}  // namespace vpm::tools
