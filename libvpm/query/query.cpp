#include "libvpm/query/query.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

// The pose that is computed with. What prunes relies on rotations that are exact, and not all of it
// is done everywhere: a rounded one would not have the same bits on a device.
Pose sound(const Pose& pose) {
  if (!is_in_range(pose.translation)) {
    refuse("the translation is not finite, or further than 2^100 m from the origin", "pose");
  }
  if (is_rotation(pose.rotation, kRotationExact)) return pose;
  if (!is_rotation(pose.rotation, kRotationRounding)) {
    refuse("its rotation is not finite, not orthonormal or mirrors", "pose",
           "make it with rotation_from_matrix or rotation_from_quaternion");
  }
  return {exact_rotation(pose.rotation), pose.translation};
}

// What a device would wait for, of each pose: body(k).
template <class Body>
void for_each_pose(std::size_t count, const Body& body) {
  constexpr std::size_t kPosesPerTask = 4096;
  parallel_for(count, kPosesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) body(k);
  });
}

void check_room(std::size_t poses, std::size_t results) {
  if (poses == results) return;
  throw Error(
      ErrorKind::invalid_argument,
      std::to_string(poses) + " poses, but room for " + std::to_string(results) + " results",
      "query");
}

// Whether one launch can answer for both.
bool go_together(const QueryOptions& a, const QueryOptions& b) {
  return a.measure == b.measure && a.device == b.device && a.counts_points == b.counts_points &&
         a.shadows == b.shadows;
}

}  // namespace

void Query::check_together(std::span<Query* const> queries, std::span<const ToolPose> poses,
                           std::span<Result> results) {
  check_room(poses.size(), results.size());
  for (const Query* query : queries) {
    if (query->options_.coherent)
      throw Error(ErrorKind::invalid_argument,
                  "coherent poses follow each other: ask for them one by one");
    if (!go_together(query->options_, queries.front()->options_)) {
      throw Error(
          ErrorKind::invalid_argument,
          "tools that are queried together need the same measure, device, shadows and points", {},
          "make their queries with the same options");
    }
  }
  for (const ToolPose& pose : poses) {
    if (pose.tool >= queries.size()) {
      throw Error(ErrorKind::invalid_argument, "a pose is of tool " + std::to_string(pose.tool) +
                                                   ", counted from 0, but there are " +
                                                   std::to_string(queries.size()));
    }
  }
}

Query::Query(const ToolModel& tool, const QueryOptions& options)
    : level_(tool.level(options.level)), options_(options), states_(level_.sphere_count) {
  if (!(options.stiffness > 0 && std::isfinite(options.stiffness))) {
    throw Error(ErrorKind::invalid_argument, "the stiffness must be a positive number");
  }
  if (!std::isfinite(options.stiffness * tool.volume * std::max(1.0, tool.reach))) {
    throw Error(ErrorKind::invalid_argument, "the stiffness is so large that forces overflow");
  }
  if (options.standby_us > QueryOptions::kLongestStandby) {
    throw Error(ErrorKind::invalid_argument,
                "a device stands by for a second (1000000 us) at most");
  }
  if (options.coherent && (options.measure == Measure::paper || options.device.is_cuda())) {
    throw Error(ErrorKind::invalid_argument,
                "coherent poses are a matter of the refined measure on the CPU", {},
                "leave the other measure or device out");
  }
  if (options.shadows == Shadows::solid && options.measure == Measure::paper) {
    throw Error(ErrorKind::invalid_argument, "solid shadows are a matter of the refined measure",
                {}, "leave the other measure out");
  }
  if (options.device.is_cuda()) {
    device_ = make_device_measure(tool, level_, options);
  } else if (options.measure == Measure::paper) {
    paper_ = std::make_unique<PaperMeasure>(tool, level_);
  } else {
    refined_ = std::make_unique<RefinedMeasure>(tool, level_, options);
  }
}

Result Query::run(const PreparedCloud& cloud, const Pose& given) {
  const Pose pose = sound(given);
  check_cloud(cloud);
  Result result;
  if (device_) {
    result = device_->run(cloud, pose);
  } else if (paper_) {
    result = paper_->run(cloud, pose, states_);
  } else {
    result = refined_->run(cloud, pose);
  }
  finish(result);
  return result;
}

Result Query::run(const DepthFrame& frame, const Pose& pose) {
  if (!device_) return run(frame.cloud(), pose);
  Result result = device_->run_frame(frame, sound(pose));
  finish(result);
  return result;
}

void Query::check_cloud(const PreparedCloud& cloud) const {
  if (options_.shadows == Shadows::solid && !cloud.is_organised() && !cloud.positions().empty()) {
    refuse(
        "of points without a camera nobody knows what they hide: solid shadows need a cloud that "
        "keeps its depth image");
  }
}

void Query::forget() {
  if (refined_) refined_->forget();
}

template <class OnDevice>
void Query::run_batch(const PreparedCloud* cloud, std::span<const Pose> poses,
                      std::span<Result> results, const OnDevice& on_device) {
  check_room(poses.size(), results.size());
  if (!device_) {
    for (std::size_t k = 0; k < poses.size(); ++k) results[k] = run(*cloud, poses[k]);
    return;
  }
  sound_.resize(poses.size());
  for_each_pose(poses.size(), [&](std::size_t k) { sound_[k] = sound(poses[k]); });
  on_device(sound_);
  for_each_pose(results.size(), [&](std::size_t k) { finish(results[k]); });
}

void Query::run(const PreparedCloud& cloud, std::span<const Pose> poses,
                std::span<Result> results) {
  check_cloud(cloud);
  run_batch(&cloud, poses, results,
            [&](std::span<const Pose> sound) { device_->run(cloud, sound, results); });
}

void Query::run(const DepthFrame& frame, std::span<const Pose> poses, std::span<Result> results) {
  run_batch(device_ ? nullptr : &frame.cloud(), poses, results,
            [&](std::span<const Pose> sound) { device_->run_frame(frame, sound, results); });
}

template <class Scene, class OnDevice>
void Query::run_tools(std::span<Query* const> queries, const Scene& scene,
                      std::span<const ToolPose> poses, std::span<Result> results,
                      const OnDevice& on_device) {
  check_together(queries, poses, results);
  if (poses.empty()) return;
  if (!queries.front()->device_) {
    for (std::size_t k = 0; k < poses.size(); ++k)
      results[k] = queries[poses[k].tool]->run(scene, poses[k].pose);
    return;
  }
  std::vector<ToolPose> sound_poses(poses.size());
  for_each_pose(poses.size(), [&](std::size_t k) {
    sound_poses[k] = {poses[k].tool, sound(poses[k].pose)};
  });
  std::vector<DeviceMeasure*> measures;
  for (const Query* query : queries) measures.push_back(query->device_.get());
  on_device(std::span<DeviceMeasure* const>(measures), std::span<const ToolPose>(sound_poses));
  for_each_pose(results.size(), [&](std::size_t k) { queries[poses[k].tool]->finish(results[k]); });
}

void Query::run_together(std::span<Query* const> queries, const PreparedCloud& cloud,
                         std::span<const ToolPose> poses, std::span<Result> results) {
  for (const Query* query : queries) query->check_cloud(cloud);
  run_tools(queries, cloud, poses, results, [&](auto measures, auto sound_poses) {
    measures.front()->run_together(measures, cloud, sound_poses, results);
  });
}

void Query::run_together(std::span<Query* const> queries, const DepthFrame& frame,
                         std::span<const ToolPose> poses, std::span<Result> results) {
  run_tools(queries, frame, poses, results, [&](auto measures, auto sound_poses) {
    measures.front()->run_frame_together(measures, frame, sound_poses, results);
  });
}

std::span<const SphereState> Query::states() const {
  if (device_) device_->read_states(states_);
  if (refined_) refined_->read_states(states_);
  return states_;
}

void Query::finish(Result& result) const {
  if (!options_.counts_points && options_.measure == Measure::refined) result.points.reset();
  result.wrench.force = options_.stiffness * result.wrench.force;
  result.wrench.torque = options_.stiffness * result.wrench.torque;
}

}  // namespace vpm
