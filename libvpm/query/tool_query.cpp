#include "libvpm/query/tool_query.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <utility>

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
  constexpr std::size_t kJobsPerTask = 1024;
  parallel_for(count, kJobsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) body(k);
  });
}

// Of jobs that threads do at once, tells the failure of the first one in their order that fails.
class FirstFailure {
 public:
  explicit FirstFailure(std::size_t jobs) : job_(jobs) {}

  // Does a job. Threads may do so at once.
  template <class Work>
  void watch(std::size_t job, const Work& work) {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (job > job_) return;
      job_ = job;
      failure_ = std::current_exception();
    }
  }
  // Returns the first job that has failed, or the number of jobs: those after it need not be done.
  std::size_t before() const { return job_; }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::atomic<std::size_t> job_;
  std::mutex mutex_;
  std::exception_ptr failure_;
};

// True if one launch can answer for both.
bool go_together(const QueryOptions& a, const QueryOptions& b) {
  return a.measure == b.measure && a.device == b.device && a.shadows == b.shadows;
}

void check_poses(const SolidsAt& solids) {
  if (!solids.poses.empty() && solids.poses.size() != solids.solids.size())
    invalid("there are poses of " + std::to_string(solids.poses.size()) +
                " solids, but the scene has " + std::to_string(solids.solids.size()),
            "give one for each, or none");
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
  if (options.contacts > 0 && (options.measure == Measure::paper || options.device.is_cuda()))
    invalid("contacts are a matter of the refined measure on the CPU",
            "leave the other measure or device out");
  if (options.interval && (options.measure == Measure::paper || options.device.is_cuda()))
    invalid("intervals are a matter of the refined measure on the CPU",
            "leave the other measure or device out");
  if (options.shadows == Shadows::solid && options.measure == Measure::paper)
    invalid("solid shadows are a matter of the refined measure", "leave the other measure out");
}

}  // namespace

ToolQuery::ToolQuery(const ToolModel& tool, const QueryOptions& options)
    : tool_(tool),
      level_(tool.level(options.level)),
      options_(options),
      states_(level_.sphere_count),
      solid_query_(std::make_shared<SolidQuery>(tool)),
      sphere_query_(tool, level_) {
  check_options(options, tool);
  if (options.device.is_cuda()) {
    device_ = make_device_measure(tool, level_, options);
  } else if (options.measure == Measure::paper) {
    paper_ = std::make_unique<PaperMeasure>(tool, level_);
  } else {
    refined_ = std::make_unique<RefinedMeasure>(tool, level_, options);
  }
}

ToolQuery::ToolQuery(const ToolQuery& other)
    : tool_(other.tool_),
      level_(other.level_),
      options_(other.options_),
      states_(level_.sphere_count),
      solid_query_(std::make_shared<SolidQuery>(*other.solid_query_)),
      sphere_query_(tool_, level_) {
  if (other.device_) device_ = make_device_measure(tool_, level_, options_);
  if (other.paper_) paper_ = std::make_unique<PaperMeasure>(*other.paper_);
  if (!other.refined_) return;
  refined_ = std::make_unique<RefinedMeasure>(*other.refined_);
  refined_->forget();
}

// Checks that each body of a scene tells what solid occluded space is.
void ToolQuery::check(std::span<const AnyBody> scene, const SolidsAt& solids) const {
  if (scene.empty() && solids.solids.empty()) invalid("a scene needs a body");
  check_poses(solids);
  for (const PlacedSolid& solid : solids.solids)
    if (paper_ && !solid.model)
      invalid("the measure as printed takes the spheres of solids, and body " +
                  std::to_string(solid.place) + ", counted from 0, is a mesh without them",
              "give its tool model (.vpmg) instead, or leave the measure out");
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

Result ToolQuery::run(std::span<const AnyBody> scene, const Pose& given, const SolidsAt& solids) {
  const Pose pose = exact_pose(given);
  check(scene, solids);
  if (device_) device_->keep_only(scene);
  SceneSum sum;
  parts_.clear(), patches_.clear();
  last_pose_ = pose;
  has_joined_states_ = scene.size() > 1 || !solids.solids.empty();
  if (has_joined_states_) of_body_.assign(states_.size(), SphereState::outside);
  for (std::size_t k = 0; k < scene.size(); ++k) {
    parts_.push_back({measure(scene[k], k, pose), std::nullopt, std::nullopt});
    sum.add(parts_.back().body);
    if (options_.contacts > 0) note_contacts(solids.place_of_other(k), pose);
    if (has_joined_states_) add_states();
  }
  std::optional<double> closure;
  if (!solids.solids.empty()) closure = add_solids(solids, pose, sum);
  whole_ = finished(sum, pose, closure);
  return whole_;
}

Collides ToolQuery::collides(std::span<const AnyBody> scene, const Pose& given, double unseen_limit,
                             const SolidsAt& solids) {
  if (!(unseen_limit >= 0 && unseen_limit <= 1))
    invalid("the part of the tool that may be unseen lies between 0 and 1");
  if (!refined_ || options_.coherent) return vpm::collides(run(scene, given, solids), unseen_limit);
  const Pose pose = exact_pose(given);
  check(scene, solids);
  SceneSum sum;
  parts_.clear();
  has_joined_states_ = false;
  for (std::size_t k = 0; k < scene.size(); ++k) {
    const std::optional<BodySum> found = refined_->run_until(Until::hit, scene[k], pose, k);
    if (!found || counts(found->sum)) return Collides::yes;
    sum.add(*found);
  }
  const std::optional<double> closure = add_solids(solids, pose, sum);
  return vpm::collides(finished(sum, pose, closure), unseen_limit);
}

std::vector<Result> ToolQuery::parts() const {
  std::vector<Result> results(parts_.size());
  std::vector<bool> is_taken(parts_.size());
  const auto result = [&](const Part& part) {
    SceneSum sum;
    sum.add(part.body);
    return finished(sum, last_pose_, part.closure);
  };
  for (const Part& part : parts_)
    if (part.place) results[*part.place] = result(part), is_taken[*part.place] = true;
  std::size_t next = 0;
  for (const Part& part : parts_) {
    if (part.place) continue;
    while (is_taken[next]) ++next;
    results[next++] = result(part);
  }
  return results;
}

std::vector<Contact> ToolQuery::contacts() const {
  std::vector<ContactPatch> patches = patches_;
  for (ContactPatch& patch : patches) {
    patch.wrench.force = options_.stiffness * patch.wrench.force;
    patch.wrench.torque = options_.stiffness * patch.wrench.torque;
  }
  return listed_contacts(std::move(patches), options_.contacts, whole_, options_.stiffness, tool_);
}

// Notes the contacts with the body that was measured last.
void ToolQuery::note_contacts(std::size_t body, const Pose& pose) {
  for (const CellContact& contact : refined_->contacts()) {
    BodySum of_contact;
    of_contact.sum = contact.sum;
    SceneSum sum;
    sum.add(of_contact);
    const Result part = sum.result(tool_, pose.rotation);
    const Vec3 centroid = 1 / contact.sum.volume.real() * contact.moment;
    patches_.push_back({body, part.volume, pose * (tool_.center_of_mass + centroid),
                        -tool_.volume * (pose.rotation * contact.section), contact.depth,
                        part.wrench});
  }
}

// Joins the states at the last body with those at the bodies before: cut by any, else inside any.
void ToolQuery::add_states() const {
  if (device_) device_->read_states(states_);
  if (refined_) refined_->read_states(states_);
  join_states();
}

void ToolQuery::join_states() const {
  for (std::size_t k = 0; k < states_.size(); ++k) {
    SphereState& joined = of_body_[k];
    if (states_[k] == SphereState::boundary || joined == SphereState::outside) joined = states_[k];
  }
}

void ToolQuery::run(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                    std::span<const Job> jobs, std::span<Result> results,
                    std::span<const PlacedSolid> solids) {
  if (jobs.size() != results.size())
    invalid(std::to_string(jobs.size()) + " jobs, but room for " + std::to_string(results.size()) +
            " results");
  for (const ToolQuery* query : queries) {
    query->check(scene, {solids, {}});
    if (query->options_.coherent && queries.size() > 1)
      invalid("coherent poses follow each other", "ask for them one by one");
    if (!go_together(query->options_, queries.front()->options_))
      invalid("tools that are queried together need the same measure, device and shadows",
              "make their queries with the same options");
  }
  for (const Job& job : jobs) {
    check_poses({solids, job.solids});
    if (job.tool >= queries.size())
      invalid("a job is of tool " + std::to_string(job.tool) + ", counted from 0, but there are " +
              std::to_string(queries.size()));
  }
  if (jobs.empty()) return;
  queries.front()->device_ ? run_on_device(queries, scene, jobs, results, solids)
                           : run_on_cpu(queries, scene, jobs, results, solids);
}

std::shared_ptr<const ResidentAnswers> ToolQuery::run(std::span<const AnyBody> scene,
                                                      const DevicePoses& poses,
                                                      std::span<const PlacedSolid> solids) {
  check(scene, {solids, {}});
  if (!device_ || options_.device.index == Device::kAll)
    invalid("poses on a device are for a query on one CUDA device", "give it `device` cuda");
  if (!solids.empty())
    invalid("the CPU measures the scene's solids, and the poses lie on a device",
            "copy the poses to the host");
  if (poses.width != 7 && poses.width != 12 && poses.width != 16)
    invalid("poses on a device have " + std::to_string(poses.width) + " numbers each",
            "give 7, or 12 or 16 of a matrix");
  device_->keep_only(scene);
  return device_->begin(scene, poses, options_.stiffness);
}

ToolQuery& ToolQuery::of_thread(std::size_t thread) {
  std::unique_ptr<ToolQuery>& query = of_threads_[thread];
  if (!query) query = std::make_unique<ToolQuery>(*this);
  query->solid_query_->share_surface_of(*solid_query_);
  return *query;
}

// Each thread takes one job after another. Where there are fewer jobs than threads, or poses are
// coherent, jobs are done in order, and all threads share each.
void ToolQuery::run_on_cpu(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                           std::span<const Job> jobs, std::span<Result> results,
                           std::span<const PlacedSolid> solids) {
  const auto threads = static_cast<std::size_t>(thread_count());
  const auto answer = [&](ToolQuery& query, std::size_t k) {
    results[k] = query.run(scene, jobs[k].pose, {solids, jobs[k].solids});
  };
  if (threads == 1 || jobs.size() < threads || queries.front()->options_.coherent) {
    for (std::size_t k = 0; k < jobs.size(); ++k) answer(*queries[jobs[k].tool], k);
    return;
  }
  for (ToolQuery* const query : queries)
    query->of_threads_.resize(std::max(query->of_threads_.size(), threads));
  if (!solids.empty())
    for (const Job& job : jobs) queries[job.tool]->prepare_surface();
  std::atomic<std::size_t> next{0};
  FirstFailure failure(jobs.size());
  parallel_for(threads, 1, [&](std::size_t thread, std::size_t) {
    const OneThread alone;
    for (std::size_t k = 0; (k = next.fetch_add(1, std::memory_order_relaxed)) < failure.before();)
      failure.watch(k, [&] { answer(queries[jobs[k].tool]->of_thread(thread), k); });
  });
  failure.rethrow();
}

// Asks body by body: all jobs before one, then before the next. The host measures solids.
void ToolQuery::run_on_device(std::span<ToolQuery* const> queries, std::span<const AnyBody> scene,
                              std::span<const Job> jobs, std::span<Result> results,
                              std::span<const PlacedSolid> solids) {
  auto& [exact, placed, of_body, sums, closures] = queries.front()->batch_room_;
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
      if (&body != scene.data()) sums[k].add(of_body[k]);  // of the body before
      placed[k] = {pose_in_body(body.to_world(), exact[k], queries[tool]->tool_.center_of_mass),
                   tool};
    });
    measures.front()->run(body, measures, placed, of_body);
  }
  closures.assign(solids.empty() ? 0 : count, {});
  for (std::size_t k = 0; k < closures.size(); ++k) {
    ToolQuery& query = *queries[jobs[k].tool];
    query.parts_.clear();
    closures[k] = query.add_solids({solids, jobs[k].solids}, exact[k], sums[k]);
  }
  for_each_job(count, [&](std::size_t k) {
    if (!scene.empty()) sums[k].add(of_body[k]);  // of the last body
    results[k] = queries[jobs[k].tool]->finished(sums[k], exact[k],
                                                 closures.empty() ? std::nullopt : closures[k]);
  });
}

// Adds what solids give, and returns the largest closure.
std::optional<double> ToolQuery::add_solids(const SolidsAt& solids, const Pose& pose,
                                            SceneSum& sum) {
  std::optional<double> closure;
  for (std::size_t k = 0; k < solids.solids.size(); ++k) {
    const SolidAnswer found = paper_
                                  ? sphere_query_.run(solids, k, pose, states_)
                                  : solid_query_->run(solids, k, pose, states_, options_.contacts);
    patches_.insert(patches_.end(), found.contacts.begin(), found.contacts.end());
    sum.add(found.body);
    closure = std::max(closure, found.closure);  // nothing is less than any
    parts_.push_back({found.body, found.closure, solids.solids[k].place});
    const bool is_touched = found.body.boundary > 0 || found.body.inside > 0;
    if (has_joined_states_ && is_touched) join_states();
  }
  return closure;
}

void ToolQuery::forget() {
  if (refined_) refined_->forget();
}

std::span<const SphereState> ToolQuery::states() const {
  if (has_joined_states_) return of_body_;
  if (device_) device_->read_states(states_);
  if (refined_) refined_->read_states(states_);
  return states_;
}

Result ToolQuery::finished(const SceneSum& sum, const Pose& pose,
                           std::optional<double> closure) const {
  Result result = sum.result(tool_, pose.rotation, options_.stiffness);
  result.closure = closure;
  if (options_.interval) result.volume_interval = sum.volume_interval(tool_.volume);
  if (options_.contacts > 0)
    result.wrench =
        wrench_of_contacts(result.wrench, result.volume, options_.stiffness, tool_.radius);
  return result;
}

}  // namespace vpm
