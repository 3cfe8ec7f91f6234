// Chooses the level of a tool model, the coarsest accurate enough or the finest fast enough, and
// runs queries of one tool at it. Programs see vpm/level_query.h.
#pragma once

#include <vpm/level_query.h>

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/model/tool_model.h"
#include "libvpm/query/scene_scale.h"
#include "libvpm/query/tool_query.h"

namespace vpm {

// Returns the index of the coarsest level whose worst calibrated error is at most `max_error`, a
// fraction of the tool's volume. Throws Error(invalid_argument) for an error outside (0, 1);
// Error(refused) for a model without a calibration, with one level only, or without a level that
// accurate.
std::size_t coarsest_level_within(const ToolModel& tool, double max_error);

// Chooses the finest level that keeps a deadline from the times of queries, which the caller
// measures. Steps down before a deadline is missed, and up again when there is time.
class DeadlineLevel {
 public:
  // `probed` holds the time of each level in the midst of a contact, coarsest first; `deadline` is
  // positive and in the same unit. Levels after `finest` are never taken.
  DeadlineLevel(std::vector<double> probed, double deadline, std::size_t finest);

  std::size_t level() const { return level_; }
  bool keeps() const;  // false if even the coarsest level is expected to miss the deadline

  // Adds the time of the last query, which ran at level().
  void took(double time);

 private:
  // Part of the deadline that the expected time may use. The rest is a reserve.
  static constexpr double kMargin = 0.8;
  // Number of last queries of which the second slowest is taken, since a lone slow one says
  // nothing.
  static constexpr std::size_t kRecent = 64;

  double slowness() const;
  void choose();

  std::vector<double> probed_;
  double deadline_;
  std::size_t finest_, level_ = 0, next_ = 0;
  std::array<double, kRecent> recent_{};  // time taken / time probed
};

// Refers to its model, which must outlive it.
class LevelToolQuery {
 public:
  // Chooses the level. Has the contract of LevelQuery.
  LevelToolQuery(const ToolModel& tool, const QueryOptions& options, const LevelRequest& request,
                 std::span<const AnyBody> scene, const Pose& first_pose);
  LevelToolQuery(const ToolModel& tool, const QueryOptions& options, const LevelRequest& request,
                 const AnyBody& body, const Pose& first_pose)
      : LevelToolQuery(tool, options, request, std::span(&body, 1), first_pose) {}

  // Makes one for another thread, at the same level; as the copy of a ToolQuery.
  LevelToolQuery(const LevelToolQuery& other);

  // Returns the answer at the current level, and chooses the next level if there is a deadline.
  Result run(std::span<const AnyBody> scene, const Pose& pose, const SolidsAt& solids = {});
  Result run(const AnyBody& body, const Pose& pose) { return run(std::span(&body, 1), pose); }
  // Stores the answers of many jobs. Requires a request without deadline. seconds() is then the
  // mean per job.
  void run(std::span<const AnyBody> scene, std::span<const Job> jobs, std::span<Result> results);
  void run(const AnyBody& body, std::span<const Job> jobs, std::span<Result> results) {
    run(std::span(&body, 1), jobs, results);
  }

  // Returns the query that ran last; without a deadline there is no other.
  const ToolQuery& query() const { return queries_[used_]; }
  ToolQuery& query() { return queries_[used_]; }
  // Returns the finest level that the request allows.
  const Level& finest() const { return queries_.back().level(); }
  double seconds() const { return seconds_; }
  LevelReason reason() const { return reason_; }
  const std::optional<SceneScale>& scale() const { return scale_; }

 private:
  std::size_t finest_wanted(const ToolModel& tool, const QueryOptions& options,
                            std::span<const AnyBody> scene, const Pose& pose);
  LevelReason reason_now() const;
  double timed_run(std::size_t k, std::span<const AnyBody> scene, const Pose& pose,
                   const SolidsAt& solids = {});
  std::vector<double> probe(const ToolModel& tool, std::span<const AnyBody> scene);

  LevelRequest request_;
  std::optional<SceneScale> scale_;
  std::deque<ToolQuery> queries_;  // coarsest first; one, without a deadline
  std::optional<DeadlineLevel> deadline_;
  std::size_t used_ = 0;
  double seconds_ = 0;
  Result result_;
  LevelReason reason_ = LevelReason::none;
};

}  // namespace vpm
