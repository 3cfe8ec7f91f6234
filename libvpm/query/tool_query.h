// Runs queries of one tool at one level: checks arguments and calls the measure of the chosen
// backend. Programs see vpm/query.h.
#pragma once

#include <vpm/query_types.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/backend/cpu/measure_paper.h"
#include "libvpm/backend/cpu/measure_refined.h"
#include "libvpm/backend/device_measure.h"
#include "libvpm/measure/body_sum.h"
#include "libvpm/query/contact_list.h"
#include "libvpm/query/solid_query.h"
#include "libvpm/scene/any_body.h"

namespace vpm {

// Refers to its model, which must outlive it and pass validate() of tool_model.h.
class ToolQuery {
 public:
  // Throws what Query throws (vpm/query.h).
  ToolQuery(const ToolModel& tool, const QueryOptions& options);
  // Makes one for another thread: shares what is immutable, and remembers no pose.
  ToolQuery(const ToolQuery& other);

  // Returns the answer for one pose before a scene's bodies. Has the contract of Query::run.
  Result run(std::span<const AnyBody> scene, const Pose& pose, const SolidsAt& solids = {});
  Result run(const AnyBody& body, const Pose& pose) { return run(std::span(&body, 1), pose); }

  // Returns collides() of that answer, sooner where it can. Has the contract of Query::collides.
  Collides collides(std::span<const AnyBody> scene, const Pose& pose, double unseen_limit,
                    const SolidsAt& solids = {});

  // Stores the answers of many jobs, whose tools are indices into `queries`. Has the contract of
  // Query::run. Throws Error(invalid_argument) unless the queries have the same options save level
  // and stiffness. A device launches up to 16 tools at once; on the CPU each thread answers jobs of
  // its own.
  static void run(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                  std::span<const Job> jobs, std::span<Result> results,
                  std::span<const PlacedSolid> solids = {});
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

  // Begins to answer poses that lie on the query's device. Has the contract of Query::run.
  std::shared_ptr<const ResidentAnswers> run(std::span<const AnyBody> scene,
                                             const DevicePoses& poses,
                                             std::span<const PlacedSolid> solids = {});

  // Prepares the tool's surface, if the measure asks for it before solids. Throws Error(refused) if
  // it has none.
  void prepare_surface() {
    if (!paper_) solid_query_->prepare();
  }
  // Takes the surface that another query of the same tool prepares for solids, or has prepared.
  void share_surface_of(const ToolQuery& other) { solid_query_ = other.solid_query_; }

  // Ends a motion of coherent poses.
  void forget();

  const Level& level() const { return level_; }
  // Returns the state of each sphere of the level at the last single pose; undefined after a batch.
  std::span<const SphereState> states() const;
  // Returns what each body gave at the last single pose, in the scene's order of bodies: solids at
  // their places, the others between them.
  std::vector<Result> parts() const;
  // Returns the contacts at the last single pose. Has the contract of Query::contacts.
  std::vector<Contact> contacts() const;

 private:
  // Memory of a batch on a device, one of each for a job; used again, since new memory costs as
  // much time as a device takes for small levels.
  struct BatchRoom {
    std::vector<Pose> exact;
    std::vector<BodyJob> placed;
    std::vector<BodySum> of_body;
    std::vector<SceneSum> sums;
    std::vector<std::optional<double>> closures;  // only where the scene has solids
  };

  static void run_on_cpu(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                         std::span<const Job> jobs, std::span<Result> results,
                         std::span<const PlacedSolid> solids);
  // Returns the copy of this for the thread of a batch, which has it for itself.
  ToolQuery& of_thread(std::size_t thread);
  static void run_on_device(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                            std::span<const Job> jobs, std::span<Result> results,
                            std::span<const PlacedSolid> solids);
  void check(std::span<const AnyBody> scene, const SolidsAt& solids) const;
  BodySum measure(const AnyBody& body, std::size_t place, const Pose& pose);
  std::optional<double> add_solids(const SolidsAt& solids, const Pose& pose, SceneSum& sum);
  void note_contacts(std::size_t body, const Pose& pose);
  void add_states() const;
  void join_states() const;
  Result finished(const SceneSum& sum, const Pose& pose, std::optional<double> closure) const;

  const ToolModel& tool_;
  const Level& level_;
  QueryOptions options_;
  // Holds exactly one of these.
  std::unique_ptr<PaperMeasure> paper_;
  std::unique_ptr<RefinedMeasure> refined_;
  std::unique_ptr<DeviceMeasure> device_;
  mutable std::vector<SphereState> states_;
  mutable std::vector<SphereState> of_body_;  // of the last one, if there are several
  bool has_joined_states_ = false;            // in of_body_, of several bodies or solids
  std::shared_ptr<SolidQuery> solid_query_;   // by surfaces
  SphereQuery sphere_query_;                  // for the measure as printed
  // What each body gave for the last single pose, and which of them were solids.
  struct Part {
    BodySum body;
    std::optional<double> closure;     // of a solid's surface
    std::optional<std::size_t> place;  // of a solid
  };
  std::vector<Part> parts_;  // solids last
  Pose last_pose_;
  // Of the last single pose, if contacts are asked for: patches without stiffness, and the answer.
  std::vector<ContactPatch> patches_;
  Result whole_;
  BatchRoom batch_room_;
  std::vector<std::unique_ptr<ToolQuery>> of_threads_;  // of a batch on the CPU, once it is asked
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
