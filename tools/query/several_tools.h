#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libvpm/file/stream.h"
#include "libvpm/recording/timed_path.h"
#include "tools/query/level_query.h"

namespace vpm::tools {

// Every pose is asked of every tool, each at its level of the request; a line for each, pose by
// pose and in the order of the tools.
class SeveralTools {
 public:
  // No deadline. The models outlive this.
  SeveralTools(std::span<const ToolModel> models, const QueryOptions& options,
               const LevelRequest& request, const PreparedCloud& cloud, const Pose& first_pose);

  // From the first pose on all of the reader, if there is one; so many at once.
  void run(std::optional<Pose> next, std::optional<PoseReader>& reader, std::size_t at_once,
           file::Output& output);

  const LevelQuery& query(std::size_t tool) const { return queries_[tool]; }
  const std::vector<double>& seconds() const { return seconds_; }  // of each answer, on average
  std::vector<std::uint32_t> levels() const;                       // spheres, of each tool

 private:
  void ask(std::span<const Pose> poses, file::Output& output);

  const PreparedCloud& cloud_;
  Measure measure_;
  std::deque<LevelQuery> queries_;
  std::vector<Query*> together_;
  std::size_t asked_ = 0;  // poses
  std::vector<double> seconds_;
};

}  // namespace vpm::tools
