#include "libvpm/query/tool_query.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/core/exact_pose.h"
#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

[[noreturn]] void invalid(const std::string& what, const std::string& hint = {}) {
  throw Error(ErrorKind::invalid_argument, what, {}, hint);
}

// Calls body(k) for each job in parallel, since a device waits for it.
template <class Body>
void for_each_job(std::size_t count, const Body& body) {
  constexpr std::size_t kJobsPerTask = 4096;
  parallel_for(count, kJobsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) body(k);
  });
}

// True if one launch can answer for both.
bool go_together(const QueryOptions& a, const QueryOptions& b) {
  return a.measure == b.measure && a.device == b.device && a.shadows == b.shadows;
}

void check_options(const QueryOptions& options, const ToolModel& tool) {
  if (!(options.stiffness > 0 && std::isfinite(options.stiffness)))
    invalid("the stiffness must be a positive number");
  if (!std::isfinite(options.stiffness * tool.volume * std::max(1.0, tool.radius)))
    invalid("the stiffness is so large that forces overflow");
  if (options.measure == Measure::paper && options.device.is_cuda())
    invalid("the measure as printed is computed on the CPU only",
            "leave the device or the other measure out");
  if (options.coherent && (options.measure == Measure::paper || options.device.is_cuda()))
    invalid("coherent poses are a matter of the refined measure on the CPU",
            "leave the other measure or device out");
  if (options.shadows == Shadows::solid && options.measure == Measure::paper)
    invalid("solid shadows are a matter of the refined measure", "leave the other measure out");
}

}  // namespace

ToolQuery::ToolQuery(const ToolModel& tool, const QueryOptions& options)
    : tool_(tool),
      level_(tool.level(options.level)),
      options_(options),
      states_(level_.sphere_count) {
  check_options(options, tool);
  if (options.device.is_cuda()) {
    device_ = make_device_measure(tool, level_, options);
  } else if (options.measure == Measure::paper) {
    paper_ = std::make_unique<PaperMeasure>(tool, level_);
  } else {
    refined_ = std::make_unique<RefinedMeasure>(tool, level_, options);
  }
}

// Checks that each body of a scene tells what solid occluded space is.
void ToolQuery::check(std::span<const AnyBody> scene) const {
  if (scene.empty()) invalid("a scene needs a body");
  if (options_.shadows != Shadows::solid) return;
  for (const AnyBody& body : scene)
    if (!body.tells_inside() && body.points() > 0)
      refuse(
          "of points without a camera nobody knows what they hide: solid shadows need a cloud that "
          "keeps its depth image");
}

BodySum ToolQuery::measure(const AnyBody& body, std::size_t place, const Pose& pose) {
  if (paper_) return paper_->run(body, pose, states_);
  if (refined_) return refined_->run(body, pose, place);
  return device_->run(body, pose_in_body(body.to_world(), pose, tool_.center_of_mass));
}

Result ToolQuery::run(std::span<const AnyBody> scene, const Pose& given) {
  const Pose pose = exact_pose(given);
  check(scene);
  if (device_) device_->keep_only(scene);
  SceneSum sum;
  bodies_ = scene.size();
  if (bodies_ > 1) of_body_.assign(states_.size(), SphereState::outside);
  for (std::size_t k = 0; k < scene.size(); ++k) {
    sum.add(measure(scene[k], k, pose));
    if (bodies_ > 1) add_states();
  }
  return finished(sum, pose);
}

// Joins the states at the last body with those at the bodies before: cut by any, else inside any.
void ToolQuery::add_states() const {
  if (device_) device_->read_states(states_);
  if (refined_) refined_->read_states(states_);
  for (std::size_t k = 0; k < states_.size(); ++k) {
    SphereState& joined = of_body_[k];
    if (states_[k] == SphereState::boundary || joined == SphereState::outside) joined = states_[k];
  }
}

void ToolQuery::run(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                    std::span<const Job> jobs, std::span<Result> results) {
  if (jobs.size() != results.size())
    invalid(std::to_string(jobs.size()) + " jobs, but room for " + std::to_string(results.size()) +
            " results");
  for (const ToolQuery* query : queries) {
    query->check(scene);
    if (query->options_.coherent && queries.size() > 1)
      invalid("coherent poses follow each other", "ask for them one by one");
    if (!go_together(query->options_, queries.front()->options_))
      invalid("tools that are queried together need the same measure, device and shadows",
              "make their queries with the same options");
  }
  for (const Job& job : jobs)
    if (job.tool >= queries.size())
      invalid("a job is of tool " + std::to_string(job.tool) + ", counted from 0, but there are " +
              std::to_string(queries.size()));
  if (jobs.empty()) return;
  if (!queries.front()->device_) {
    for (std::size_t k = 0; k < jobs.size(); ++k)
      results[k] = queries[jobs[k].tool]->run(scene, jobs[k].pose);
    return;
  }
  run_on_device(queries, scene, jobs, results);
}

// Asks body by body: all jobs before one, then before the next.
void ToolQuery::run_on_device(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                              std::span<const Job> jobs, std::span<Result> results) {
  auto& [exact, placed, of_body, sums] = queries.front()->batch_room_;
  const std::size_t count = jobs.size();
  exact.resize(count);
  placed.resize(count);
  of_body.resize(count);
  sums.resize(count);
  for_each_job(count, [&](std::size_t k) {
    exact[k] = exact_pose(jobs[k].pose);
    sums[k] = {};
  });
  std::vector<DeviceMeasure*> measures;
  for (const ToolQuery* query : queries) measures.push_back(query->device_.get());
  measures.front()->keep_only(scene);
  for (const AnyBody& body : scene) {
    for_each_job(count, [&](std::size_t k) {
      const std::uint32_t tool = jobs[k].tool;
      placed[k] = {pose_in_body(body.to_world(), exact[k], queries[tool]->tool_.center_of_mass),
                   tool};
    });
    measures.front()->run(body, measures, placed, of_body);
    const bool is_last = &body == &scene.back();
    for_each_job(count, [&](std::size_t k) {
      sums[k].add(of_body[k]);
      if (is_last) results[k] = queries[jobs[k].tool]->finished(sums[k], exact[k]);
    });
  }
}

void ToolQuery::forget() {
  if (refined_) refined_->forget();
}

std::span<const SphereState> ToolQuery::states() const {
  if (bodies_ > 1) return of_body_;
  if (device_) device_->read_states(states_);
  if (refined_) refined_->read_states(states_);
  return states_;
}

Result ToolQuery::finished(const SceneSum& sum, const Pose& pose) const {
  Result result = sum.result(tool_, pose.rotation);
  result.wrench.force = options_.stiffness * result.wrench.force;
  result.wrench.torque = options_.stiffness * result.wrench.torque;
  return result;
}

}  // namespace vpm
