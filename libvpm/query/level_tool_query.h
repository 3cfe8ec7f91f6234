// Runs queries of one tool at the level that a request chooses. Programs see vpm/level_query.h.
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libvpm/include/vpm/level_query.h"
#include "libvpm/query/level_choice.h"
#include "libvpm/query/scene_scale.h"
#include "libvpm/query/tool_query.h"

namespace vpm {

// Refers to its model, which must outlive it.
class LevelToolQuery {
 public:
  // Chooses the level. Has the contract of LevelQuery.
  LevelToolQuery(const ToolModel& tool, const QueryOptions& options, const LevelRequest& request,
                 const SceneView& scene, const Pose& first_pose);

  // Returns the answer at the current level, and chooses the next level if there is a deadline.
  Result run(const SceneView& scene, const Pose& pose);
  // Stores the answers of many jobs. Requires a request without deadline. seconds() is then the
  // mean per job.
  void run(const SceneView& scene, std::span<const Job> jobs, std::span<Result> results);

  // Returns the query that ran last; without a deadline there is no other.
  const ToolQuery& query() const { return queries_[used_]; }
  ToolQuery& query() { return queries_[used_]; }
  // Returns the finest level that the request allows.
  const Level& finest() const { return queries_.back().level(); }
  double seconds() const { return seconds_; }
  const std::string& reason() const { return reason_; }
  const std::optional<SceneScale>& scale() const { return scale_; }

 private:
  std::size_t finest_wanted(const ToolModel& tool, const QueryOptions& options,
                            const SceneView& scene, const Pose& pose);
  std::string reason_now() const;
  double timed_run(std::size_t k, const SceneView& scene, const Pose& pose);
  std::vector<double> probe(const ToolModel& tool, const SceneView& scene);

  LevelRequest request_;
  std::optional<SceneScale> scale_;
  std::deque<ToolQuery> queries_;  // coarsest first; one, without a deadline
  std::optional<DeadlineLevel> deadline_;
  std::size_t used_ = 0;
  double seconds_ = 0;
  Result result_;
  std::string reason_;
};

}  // namespace vpm
