// Measures computed on a CUDA device: the same bits as PaperMeasure and RefinedMeasure.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/query_options.h"
#include "libvpm/query/result.h"
#include "libvpm/query/tool_pose.h"
#include "libvpm/surface/depth_frames.h"
#include "libvpm/surface/prepared_cloud.h"

namespace vpm {

// The tool's level stays on the device; a cloud is copied there when it is first queried.
class DeviceMeasure {
 public:
  virtual ~DeviceMeasure() = default;

  // Of a prepared cloud, one launch at most and one wait; allocates nothing after the first call on
  // a cloud. Poses must be valid (query.h). Throw Error(unavailable) where the device fails.
  virtual Result run(const PreparedCloud& cloud, const Pose& pose) = 0;

  // Results in the order of the poses; from any thread. Poses are cut into launches that fit the
  // device's memory.
  virtual void run(const PreparedCloud& cloud, std::span<const Pose> poses,
                   std::span<Result> results) = 0;

  // The same of frames, which lie on the device already.
  virtual Result run_frame(const DepthFrame& frame, const Pose& pose) {
    return run(frame.cloud(), pose);
  }
  virtual void run_frame(const DepthFrame& frame, std::span<const Pose> poses,
                         std::span<Result> results) {
    run(frame.cloud(), poses, results);
  }

  // Of several tools: `measures` are this one and others that were made with the same options, but
  // for the level. Poses of many tools share a launch.
  virtual void run_together(std::span<DeviceMeasure* const> measures, const PreparedCloud& cloud,
                            std::span<const ToolPose> poses, std::span<Result> results) {
    for (std::size_t k = 0; k < poses.size(); ++k)
      results[k] = measures[poses[k].tool]->run(cloud, poses[k].pose);
  }
  virtual void run_frame_together(std::span<DeviceMeasure* const> measures, const DepthFrame& frame,
                                  std::span<const ToolPose> poses, std::span<Result> results) {
    run_together(measures, frame.cloud(), poses, results);
  }

  // Of the last single run.
  virtual void read_states(std::vector<SphereState>& states) = 0;
  // What came after the boundary was known, by the device's clock: next to nothing where a camera
  // tells what is inside.
  virtual double flood_microseconds() const = 0;
};

// Of the options, what speaks of measure, points and device. On Device::kAll, single poses go to
// the first device. Throws Error(unavailable) where libvpm was built without CUDA, or the device
// has too little memory.
std::unique_ptr<DeviceMeasure> make_device_measure(const ToolModel& tool, const Level& level,
                                                   const QueryOptions& options);

}  // namespace vpm
