#include "libvpm/query/level_tool_query.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

std::string percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * fraction);
  return text;
}

// Returns the least number of per cent with three digits that is not below the fraction, so that
// who asks for it gets it.
std::string percent_from(double fraction) {
  const double digits = std::pow(10, 2 - std::floor(std::log10(100 * fraction)));
  double steps = std::round(100 * fraction * digits);
  if (steps / digits / 100 < fraction) ++steps;
  return percent(steps / digits / 100);
}

}  // namespace

std::size_t coarsest_level_within(const ToolModel& tool, double max_error) {
  if (!(max_error > 0 && max_error < 1)) {
    throw Error(ErrorKind::invalid_argument, "the error must lie between 0 and 1 (0 % and 100 %)");
  }
  if (tool.calibration.size() != tool.levels.size()) {
    refuse("the tool model has no calibration", {}, "make it again with `calibrate`");
  }
  if (tool.levels.size() < 2) {
    refuse("the tool model has one level only", {}, "make it again with `levels`");
  }
  double best = 1;
  for (std::size_t k = 0; k < tool.levels.size(); ++k) {
    if (tool.calibration[k].worst <= max_error) return k;
    best = std::min(best, tool.calibration[k].worst);
  }
  refuse("no level of the tool model keeps an error of " + percent(max_error), {},
         "the best has " + percent_from(best) + ": allow as much, or pack more spheres");
}

DeadlineLevel::DeadlineLevel(std::vector<double> probed, double deadline, std::size_t finest)
    : probed_(std::move(probed)), deadline_(deadline), finest_(finest) {
  choose();
}

// Returns the ratio of times taken to times probed, at least 1: a tool in free space is fast and
// says nothing about the next contact.
double DeadlineLevel::slowness() const {
  std::array<double, kRecent> sorted = recent_;
  std::nth_element(sorted.begin(), sorted.end() - 2, sorted.end());
  return std::max(1.0, sorted[kRecent - 2]);
}

void DeadlineLevel::choose() {
  const double room = kMargin * deadline_ / slowness();
  level_ = finest_;
  while (level_ > 0 && probed_[level_] > room) --level_;
}

bool DeadlineLevel::keeps() const {
  return probed_[level_] * slowness() <= deadline_;
}

void DeadlineLevel::took(double time) {
  recent_[next_] = time / probed_[level_];
  next_ = (next_ + 1) % kRecent;
  choose();
}

namespace {

// Number of places of the cloud at which a level is timed, and of runs at each, whose median
// counts.
constexpr std::size_t kProbes = 8, kRunsPerProbe = 3;
// Shorter than any query, s; what takes less counts as this, so that ratios of times stay finite.
constexpr double kShortest = 1e-8;

}  // namespace

LevelToolQuery::LevelToolQuery(const ToolModel& tool, const QueryOptions& options,
                               const LevelRequest& request, std::span<const AnyBody> scene,
                               const Pose& first_pose)
    : request_(request) {
  if (!request.asks()) {
    queries_.emplace_back(tool, options);
    return;
  }
  const std::size_t finest = finest_wanted(tool, options, scene, first_pose);
  if (request.deadline_seconds && tool.levels.size() < 2) {
    refuse("the tool model has one level only, so that a deadline cannot choose", {},
           "make it again with `levels`");
  }
  for (std::size_t k = request.deadline_seconds ? 0 : finest; k <= finest; ++k) {
    QueryOptions of_level = options;
    of_level.level = tool.levels[k].sphere_count;
    queries_.emplace_back(tool, of_level);
    queries_.back().share_surface_of(queries_.front());
  }
  if (request.deadline_seconds)
    deadline_.emplace(probe(tool, scene), *request.deadline_seconds, finest);
  reason_ = reason_now();
}

LevelToolQuery::LevelToolQuery(const LevelToolQuery& other)
    : request_(other.request_),
      scale_(other.scale_),
      queries_(other.queries_),
      deadline_(other.deadline_),
      used_(other.used_),
      reason_(other.reason_) {
  for (ToolQuery& query : queries_) query.share_surface_of(queries_.front());
}

// Returns the index of the finest level that the request allows.
std::size_t LevelToolQuery::finest_wanted(const ToolModel& tool, const QueryOptions& options,
                                          std::span<const AnyBody> scene, const Pose& pose) {
  if (request_.max_error) {
    if (options.measure == Measure::paper) {
      throw Error(ErrorKind::invalid_argument,
                  "`max_error` is about the refined measure, which calibrations measure", {},
                  "leave `measure` paper out");
    }
    return coarsest_level_within(tool, *request_.max_error);
  }
  if (request_.for_scene) {
    scale_ = scene_scale(scene, tool.radius, pose * tool.center_of_mass);
    return level_for_scene(tool, *scale_);
  }
  return tool.levels.size() - 1;
}

double LevelToolQuery::timed_run(std::size_t k, std::span<const AnyBody> scene, const Pose& pose,
                                 const SolidsAt& solids) {
  const auto begin = std::chrono::steady_clock::now();
  result_ = queries_[k].run(scene, pose, solids);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Result LevelToolQuery::run(std::span<const AnyBody> scene, const Pose& pose,
                           const SolidsAt& solids) {
  used_ = deadline_ ? deadline_->level() : 0;
  reason_ = reason_now();
  seconds_ = timed_run(used_, scene, pose, solids);
  if (deadline_) deadline_->took(std::max(seconds_, kShortest));
  return result_;
}

void LevelToolQuery::run(std::span<const AnyBody> scene, std::span<const Job> jobs,
                         std::span<Result> results) {
  reason_ = reason_now();
  const auto begin = std::chrono::steady_clock::now();
  queries_[used_].run(scene, jobs, results);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  seconds_ = took.count() / static_cast<double>(std::max<std::size_t>(jobs.size(), 1));
}

LevelReason LevelToolQuery::reason_now() const {
  const LevelReason wanted = request_.max_error   ? LevelReason::max_error
                             : request_.for_scene ? LevelReason::scene
                                                  : LevelReason::none;
  if (!deadline_) return wanted;
  if (!deadline_->keeps()) return LevelReason::deadline_missed;
  if (wanted == LevelReason::none) return LevelReason::deadline;
  if (used_ + 1 == queries_.size()) return wanted;
  return wanted == LevelReason::max_error ? LevelReason::deadline_over_max_error
                                          : LevelReason::deadline_over_scene;
}

std::vector<double> LevelToolQuery::probe(const ToolModel& tool, std::span<const AnyBody> scene) {
  std::vector<double> slowest(queries_.size(), kShortest);
  for (const AnyBody& body : scene) {
    const std::size_t points = body.positions().size();
    for (std::size_t p = 0; p < std::min(kProbes, points); ++p) {
      const std::size_t point = (2 * p + 1) * points / (2 * kProbes);
      const Vec3 place = body.origin() + widen(body.positions()[std::min(point, points - 1)]);
      const Pose pose{{}, place - tool.center_of_mass};
      for (std::size_t k = 0; k < queries_.size(); ++k) {
        std::array<double, kRunsPerProbe> times{};
        for (double& time : times) time = timed_run(k, scene, pose);
        std::sort(times.begin(), times.end());
        slowest[k] = std::max(slowest[k], times[kRunsPerProbe / 2]);
      }
    }
  }
  return slowest;
}

}  // namespace vpm
