#include "tools/query/level_query.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>

#include "libvpm/core/error.h"

namespace vpm::tools {
namespace {

// Places of the cloud on which the levels are timed, and runs at each, of which the middle counts.
constexpr std::size_t kProbes = 8, kRunsPerProbe = 3;
// Less than any query takes, so that ratios of times stay finite.
constexpr double kShortest = 1e-8;

}  // namespace

double fraction_from_text(const std::string& text, const std::string& option) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  const std::string_view unit(stop, static_cast<std::size_t>(end - stop));
  if (fault != std::errc() || (!unit.empty() && unit != "%") || !(value > 0)) {
    throw Error(ErrorKind::invalid_argument,
                option + " " + text + ": give a share of the tool's volume like 0.5% or 0.005");
  }
  return unit.empty() ? value : value / 100;
}

LevelQuery::LevelQuery(const ToolModel& tool, const QueryOptions& options,
                       const LevelRequest& request, const PreparedCloud& cloud,
                       const Pose& first_pose)
    : request_(request) {
  if (!request.asks()) {
    queries_.emplace_back(tool, options);
    return;
  }
  const std::size_t finest = finest_wanted(tool, options, cloud, first_pose);
  if (request.deadline_seconds && tool.levels.size() < 2) {
    refuse("the tool model has one level only, so that a deadline cannot choose", {},
           "make it again with `levels`");
  }
  for (std::size_t k = request.deadline_seconds ? 0 : finest; k <= finest; ++k) {
    QueryOptions of_level = options;
    of_level.level = tool.levels[k].sphere_count;
    queries_.emplace_back(tool, of_level);
  }
  if (request.deadline_seconds)
    deadline_.emplace(probe(tool, cloud), *request.deadline_seconds, finest);
  reason_ = reason_now();
}

// The finest level to be used, by index: the finest there is for nothing but a deadline.
std::size_t LevelQuery::finest_wanted(const ToolModel& tool, const QueryOptions& options,
                                      const PreparedCloud& cloud, const Pose& pose) {
  if (request_.max_error) {
    if (options.measure == Measure::paper) {
      throw Error(ErrorKind::invalid_argument,
                  "`max_error` is about the refined measure, which calibrations measure", {},
                  "leave `measure` paper out");
    }
    return coarsest_level_within(tool, *request_.max_error);
  }
  if (request_.for_scene) {
    scale_ = scene_scale(cloud, tool.reach, pose * tool.center_of_mass);
    return level_for_scene(tool, *scale_);
  }
  return tool.levels.size() - 1;
}

template <class Scene>
double LevelQuery::timed_run(std::size_t k, const Scene& scene, const Pose& pose) {
  const auto begin = std::chrono::steady_clock::now();
  result_ = queries_[k].run(scene, pose);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

template <class Scene>
Result LevelQuery::run_in(const Scene& scene, const Pose& pose) {
  used_ = deadline_ ? deadline_->level() : 0;
  reason_ = reason_now();
  seconds_ = timed_run(used_, scene, pose);
  if (deadline_) deadline_->took(std::max(seconds_, kShortest));
  return result_;
}

Result LevelQuery::run(const PreparedCloud& cloud, const Pose& pose) {
  return run_in(cloud, pose);
}

Result LevelQuery::run(const DepthFrame& frame, const Pose& pose) {
  return run_in(frame, pose);
}

void LevelQuery::run(const PreparedCloud& cloud, std::span<const Pose> poses,
                     std::span<Result> results) {
  reason_ = reason_now();
  const auto begin = std::chrono::steady_clock::now();
  queries_[used_].run(cloud, poses, results);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  seconds_ = took.count() / static_cast<double>(std::max<std::size_t>(poses.size(), 1));
}

std::string LevelQuery::reason_now() const {
  std::string wanted = request_.max_error ? "max-error" : request_.for_scene ? "scene" : "";
  if (!deadline_) return wanted;
  if (!deadline_->keeps()) return "deadline missed";
  if (wanted.empty()) return "deadline";
  return used_ + 1 < queries_.size() ? "deadline over " + wanted : wanted;
}

std::vector<double> LevelQuery::probe(const ToolModel& tool, const PreparedCloud& cloud) {
  std::vector<double> slowest(queries_.size(), kShortest);
  const std::size_t points = cloud.positions().size();
  for (std::size_t k = 0; k < queries_.size(); ++k) {
    for (std::size_t p = 0; p < std::min(kProbes, points); ++p) {
      const std::size_t point = (2 * p + 1) * points / (2 * kProbes);
      const Vec3 place = cloud.origin() + widen(cloud.positions()[std::min(point, points - 1)]);
      const Pose pose{{}, place - tool.center_of_mass};
      std::array<double, kRunsPerProbe> times{};
      for (double& time : times) time = timed_run(k, cloud, pose);
      std::sort(times.begin(), times.end());
      slowest[k] = std::max(slowest[k], times[kRunsPerProbe / 2]);
    }
  }
  return slowest;
}

}  // namespace vpm::tools
