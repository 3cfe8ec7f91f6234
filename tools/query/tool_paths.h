// Paths of tools that move at once.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/recording/timed_path.h"
#include "tools/common/program.h"

namespace vpm::tools {

// The path of each tool, or one for all, sampled at the rate of a loop. With times the steps go
// from the first time that all paths have to the last, without from pose to pose.
class ToolPaths {
 public:
  // Reads the files and prints what is said of them. `rate` is in steps per second. The first may
  // move the scene's `solids`. Throws what the reader throws, and Error(refused) if paths share no
  // time, if only some have times, if those without differ in length, and if another path moves
  // solids, or the first another number.
  ToolPaths(const Program& program, const std::vector<std::string>& names, double rate,
            std::size_t solids);

  std::size_t steps() const { return steps_->steps(); }
  // Returns the seconds from the first step to this one.
  double time(std::size_t step) const { return steps_->time(step); }
  Pose pose(std::size_t tool, std::size_t step) const;
  // Returns the poses of the scene's solids; none if they stay.
  std::vector<Pose> solids(std::size_t step) const;

  // Returns the frame that the poses are in, if a recording tells it.
  const std::string& world() const { return world_; }
  bool has_times() const { return paths_.front().has_times(); }
  // Return the times of the first and of the last step, s; need has_times().
  double start() const { return steps_->path().start(); }
  double end() const { return steps_->path().end(); }

 private:
  std::string world_;
  std::vector<TimedPath> paths_;
  std::optional<SampledPath> steps_;  // a path over the time of all
};

}  // namespace vpm::tools
