// Measures computed on a CUDA device: the same bits as PaperMeasure and RefinedMeasure.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/query_options.h"
#include "libvpm/query/result.h"
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
