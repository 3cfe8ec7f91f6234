#include "libvpm/query/tool_query.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

[[noreturn]] void invalid(const std::string& what, const std::string& hint = {}) {
  throw Error(ErrorKind::invalid_argument, what, {}, hint);
}

// Returns the pose with an exact rotation. Pruning relies on exact rotations and differs between
// devices, so a rounded one would change bits.
Pose exact_pose(const Pose& pose) {
  if (!is_in_range(pose.translation))
    refuse("the translation is not finite, or further than 2^100 m from the origin", "pose");
  if (is_rotation(pose.rotation, kRotationExact)) return pose;
  if (!is_rotation(pose.rotation, kRotationRounding))
    refuse("its rotation is not finite, not orthonormal or mirrors", "pose",
           "make it with rotation_from_matrix or rotation_from_quaternion");
  return {exact_rotation(pose.rotation), pose.translation};
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
  return a.measure == b.measure && a.device == b.device && a.occluded == b.occluded;
}

void check_options(const QueryOptions& options, const ToolModel& tool) {
  if (!(options.stiffness > 0 && std::isfinite(options.stiffness)))
    invalid("the stiffness must be a positive number");
  if (!std::isfinite(options.stiffness * tool.volume * std::max(1.0, tool.reach)))
    invalid("the stiffness is so large that forces overflow");
  if (options.measure == Measure::paper && options.device.is_cuda())
    invalid("the measure as printed is computed on the CPU only",
            "leave the device or the other measure out");
  if (options.coherent && (options.measure == Measure::paper || options.device.is_cuda()))
    invalid("coherent poses are a matter of the refined measure on the CPU",
            "leave the other measure or device out");
  if (options.occluded == OccludedSpace::solid && options.measure == Measure::paper)
    invalid("solid shadows are a matter of the refined measure", "leave the other measure out");
}

}  // namespace

ToolQuery::ToolQuery(const ToolModel& tool, const QueryOptions& options)
    : level_(tool.level(options.level)), options_(options), states_(level_.sphere_count) {
  check_options(options, tool);
  if (options.device.is_cuda()) {
    device_ = make_device_measure(tool, level_, options);
  } else if (options.measure == Measure::paper) {
    paper_ = std::make_unique<PaperMeasure>(tool, level_);
  } else {
    refined_ = std::make_unique<RefinedMeasure>(tool, level_, options);
  }
}

// Checks that solid occluded space has a camera. A frame has one; the CPU must not prepare it here.
void ToolQuery::check(const SceneView& scene) const {
  if (options_.occluded != OccludedSpace::solid || scene.frame() != nullptr) return;
  if (!scene.cloud().is_organised() && !scene.cloud().positions().empty())
    refuse(
        "of points without a camera nobody knows what they hide: solid shadows need a cloud that "
        "keeps its depth image");
}

Result ToolQuery::run(const SceneView& scene, const Pose& given) {
  const Pose pose = exact_pose(given);
  check(scene);
  Result result;
  if (device_) {
    result = device_->run(scene, pose);
  } else if (paper_) {
    result = paper_->run(scene.cloud(), pose, states_);
  } else {
    result = refined_->run(scene.cloud(), pose);
  }
  finish(result);
  return result;
}

void ToolQuery::run(std::span<ToolQuery* const> queries, const SceneView& scene,
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
  std::vector<Job> exact(jobs.size());
  for_each_job(jobs.size(), [&](std::size_t k) {
    exact[k] = {exact_pose(jobs[k].pose), jobs[k].tool};
  });
  std::vector<DeviceMeasure*> measures;
  for (const ToolQuery* query : queries) measures.push_back(query->device_.get());
  measures.front()->run(scene, measures, exact, results);
  for_each_job(jobs.size(), [&](std::size_t k) { queries[jobs[k].tool]->finish(results[k]); });
}

void ToolQuery::forget() {
  if (refined_) refined_->forget();
}

std::span<const SphereState> ToolQuery::states() const {
  if (device_) device_->read_states(states_);
  if (refined_) refined_->read_states(states_);
  return states_;
}

void ToolQuery::finish(Result& result) const {
  result.wrench.force = options_.stiffness * result.wrench.force;
  result.wrench.torque = options_.stiffness * result.wrench.torque;
}

}  // namespace vpm
