// Runs queries of one tool at one level: checks arguments and calls the measure of the chosen
// backend. Programs see vpm/query.h.
#pragma once

#include <vpm/query_types.h>

#include <memory>
#include <span>
#include <vector>

#include "libvpm/backend/cpu/measure_paper.h"
#include "libvpm/backend/cpu/measure_refined.h"
#include "libvpm/backend/device_measure.h"
#include "libvpm/measure/body_sum.h"
#include "libvpm/scene/any_body.h"

namespace vpm {

// Refers to its model, which must outlive it and pass validate() of tool_model.h.
class ToolQuery {
 public:
  // Throws what Query throws (vpm/query.h).
  ToolQuery(const ToolModel& tool, const QueryOptions& options);

  // Returns the answer for one pose before a scene's bodies. Has the contract of Query::run.
  Result run(std::span<const AnyBody> scene, const Pose& pose);
  Result run(const AnyBody& body, const Pose& pose) { return run(std::span(&body, 1), pose); }

  // Stores the answers of many jobs, whose tools are indices into `queries`. Has the contract of
  // Query::run. Throws Error(invalid_argument) unless the queries have the same options save level
  // and stiffness. A device launches up to 16 tools at once.
  static void run(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                  std::span<const Job> jobs, std::span<Result> results);
  static void run(std::span<ToolQuery* const> queries, const AnyBody& body,
                  std::span<const Job> jobs, std::span<Result> results) {
    run(queries, std::span(&body, 1), jobs, results);
  }

  void run(std::span<const AnyBody> scene, std::span<const Job> jobs, std::span<Result> results) {
    ToolQuery* const self = this;
    run({&self, 1}, scene, jobs, results);
  }
  void run(const AnyBody& body, std::span<const Job> jobs, std::span<Result> results) {
    run(std::span(&body, 1), jobs, results);
  }

  // Ends a motion of coherent poses.
  void forget();

  const Level& level() const { return level_; }
  // Returns the state of each sphere of the level at the last single pose; undefined after a batch.
  std::span<const SphereState> states() const;

 private:
  // Memory of a batch on a device, one of each for a job; used again, since new memory costs as
  // much time as a device takes for small levels.
  struct BatchRoom {
    std::vector<Pose> exact;
    std::vector<BodyJob> placed;
    std::vector<BodySum> of_body;
    std::vector<SceneSum> sums;
  };

  static void run_on_device(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                            std::span<const Job> jobs, std::span<Result> results);
  void check(std::span<const AnyBody> scene) const;
  BodySum measure(const AnyBody& body, std::size_t place, const Pose& pose);
  void add_states() const;
  Result finished(const SceneSum& sum, const Pose& pose) const;

  const ToolModel& tool_;
  const Level& level_;
  QueryOptions options_;
  // Holds exactly one of these.
  std::unique_ptr<PaperMeasure> paper_;
  std::unique_ptr<RefinedMeasure> refined_;
  std::unique_ptr<DeviceMeasure> device_;
  mutable std::vector<SphereState> states_;
  mutable std::vector<SphereState> of_body_;  // of the last one, if there are several
  std::size_t bodies_ = 1;                    // of the scene asked last
  BatchRoom batch_room_;
};

// Returns where a measure is computed if queries may use `device`: there, but the measure as
// printed on the CPU.
inline Device device_for(Measure measure, const Device& device) {
  return measure == Measure::paper ? Device{} : device;
}

// Returns the job of each pose for a single tool.
inline std::vector<Job> jobs_of(std::span<const Pose> poses) {
  std::vector<Job> jobs;
  jobs.reserve(poses.size());
  for (const Pose& pose : poses) jobs.push_back({pose, 0});
  return jobs;
}

}  // namespace vpm
