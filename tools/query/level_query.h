#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/query/level_choice.h"
#include "libvpm/query/query.h"
#include "libvpm/query/scene_scale.h"

namespace vpm::tools {

// A fraction as users write it: "0.5%" or "0.005". Throws Error(invalid_argument) naming `option`.
double fraction_from_text(const std::string& text, const std::string& option);

struct LevelRequest {
  std::optional<double> max_error;         // fraction of the tool's volume
  std::optional<double> deadline_seconds;  // for each query; it wins over the others
  bool for_scene = false;                  // as fine as the cloud can resolve

  bool asks() const { return max_error || deadline_seconds || for_scene; }
};

// Queries at the level that the request chooses. With a deadline the level, and so the result,
// depends on the speed of the machine.
class LevelQuery {
 public:
  // With a deadline the levels are timed here first, the tool set on places of the cloud.
  // `first_pose` says where the tool will be, for the scene's scale.
  LevelQuery(const ToolModel& tool, const QueryOptions& options, const LevelRequest& request,
             const PreparedCloud& cloud, const Pose& first_pose);

  Result run(const PreparedCloud& cloud, const Pose& pose);
  Result run(const DepthFrame& frame, const Pose& pose);
  // Many at once, without a deadline; seconds() is then the time of each on average.
  void run(const PreparedCloud& cloud, std::span<const Pose> poses, std::span<Result> results);

  // Of the last run.
  const Query& query() const { return queries_[used_]; }
  Query& query() { return queries_[used_]; }  // without a deadline, the one that is used
  const Level& finest() const { return queries_.back().level(); }  // that the request allows
  double seconds() const { return seconds_; }
  // How the level was chosen; "" where nothing was asked for.
  const std::string& reason() const { return reason_; }

  const std::optional<SceneScale>& scale() const { return scale_; }  // where it was asked for

 private:
  std::size_t finest_wanted(const ToolModel& tool, const QueryOptions& options,
                            const PreparedCloud& cloud, const Pose& pose);
  std::string reason_now() const;
  template <class Scene>
  Result run_in(const Scene& scene, const Pose& pose);
  template <class Scene>
  double timed_run(std::size_t k, const Scene& scene, const Pose& pose);
  std::vector<double> probe(const ToolModel& tool, const PreparedCloud& cloud);

  LevelRequest request_;
  std::optional<SceneScale> scale_;
  std::deque<Query> queries_;  // coarsest first; one, without a deadline
  std::optional<DeadlineLevel> deadline_;
  std::size_t used_ = 0;
  double seconds_ = 0;
  Result result_;
  std::string reason_;
};

}  // namespace vpm::tools
