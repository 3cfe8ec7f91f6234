#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libvpm/file/stream.h"
#include "libvpm/query/level_tool_query.h"
#include "libvpm/recording/timed_path.h"
#include "tools/query/pose_view.h"

namespace vpm::tools {

// Asks every pose of every tool, each at the level that the request chooses, and writes a line for
// each, pose by pose in the order of the tools.
class SeveralTools {
 public:
  // Takes no deadline. The models must outlive this.
  SeveralTools(std::span<const ToolModel> models, const QueryOptions& options,
               const LevelRequest& request, const PreparedCloud& cloud, const Pose& first_pose);

  // Queries the first pose and then all poses of the reader, if there is one, `at_once` poses at a
  // time.
  void run(std::optional<Pose> next, std::optional<PoseReader>& reader, std::size_t at_once,
           file::Output& output, std::optional<PoseView>& view);

  const LevelToolQuery& query(std::size_t tool) const { return queries_[tool]; }
  const std::vector<double>& seconds() const { return seconds_; }  // mean of each answer
  std::vector<std::uint32_t> levels() const;  // number of spheres for each tool

 private:
  void ask(std::span<const Pose> poses, file::Output& output, std::optional<PoseView>& view);

  const PreparedCloud& cloud_;
  Measure measure_;
  std::deque<LevelToolQuery> queries_;
  std::vector<ToolQuery*> together_;
  std::size_t asked_ = 0;  // poses so far
  std::vector<double> seconds_;
};

}  // namespace vpm::tools
