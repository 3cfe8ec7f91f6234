#include "tools/query/tool_paths.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "libvpm/core/error.h"
#include "tools/common/recorded_frames.h"
#include "tools/common/remarks.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

TimedPath read_path(const Program& program, const std::string& name, std::string& world) {
  PoseReader reader(name);
  say(program, name, reader.remarks());
  if (!reader.world().empty() && !world.empty() && reader.world() != world)
    refuse("the paths of the tools are in two frames, " + world + " and " + reader.world(), name,
           "name the poses of one world: FILE:WORLD:FRAME");
  if (!reader.world().empty()) world = reader.world();
  TimedPath path(reader);
  note_deviation(program, name, reader.largest_deviation());
  note_lines(program, name, path.undefined(), path.doubled());
  warn_of_gap(program, name, path.improbable_gap());
  return path;
}

// Throws Error(refused) unless the paths can be walked side by side.
void check_alike(const std::vector<std::string>& names, const std::vector<TimedPath>& paths) {
  const TimedPath& first = paths.front();
  for (std::size_t k = 1; k < paths.size(); ++k) {
    if (paths[k].has_times() != first.has_times())
      refuse("only one of " + names.front() + " and " + names[k] + " has times", {},
             "give times to both, or to none");
    if (!first.has_times() && paths[k].poses().size() != first.poses().size())
      refuse(names.front() + " has " + std::to_string(first.poses().size()) + " poses, and " +
                 names[k] + " " + std::to_string(paths[k].poses().size()),
             {}, "give each a pose for every step, or times");
  }
}

// Returns a path over the time that all of them have.
TimedPath common_time(const std::vector<TimedPath>& paths) {
  double from = -std::numeric_limits<double>::infinity(), to = -from;
  for (const TimedPath& path : paths) {
    from = std::max(from, path.start());
    to = std::min(to, path.end());
  }
  if (from > to) refuse("the paths of the tools share no time", {}, "give paths of one recording");
  if (from == to) return {{from}, {Pose{}}};
  return {{from, to}, {Pose{}, Pose{}}};
}

}  // namespace

ToolPaths::ToolPaths(const Program& program, const std::vector<std::string>& names, double rate,
                     std::size_t solids) {
  for (const std::string& name : names) paths_.push_back(read_path(program, name, world_));
  check_alike(names, paths_);
  check_moving_solids(names.front(), paths_.front().solids(), solids);
  for (std::size_t k = 1; k < paths_.size(); ++k)
    if (paths_[k].solids() > 0)
      refuse("\"solids\" move with the first path only", names[k], "give them in " + names.front());
  steps_.emplace(has_times() ? common_time(paths_) : paths_.front(), rate);
}

Pose ToolPaths::pose(std::size_t tool, std::size_t step) const {
  const TimedPath& path = paths_[std::min(tool, paths_.size() - 1)];  // or one for all
  return has_times() ? path.at(start() + time(step)) : path.poses()[step];
}

std::vector<Pose> ToolPaths::solids(std::size_t step) const {
  const TimedPath& path = paths_.front();
  return has_times() ? path.solids_at(start() + time(step)) : path.solids_of(step);
}

}  // namespace vpm::tools
