// Measures computed on CUDA devices: the same bits as PaperMeasure and RefinedMeasure.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "libvpm/include/vpm/query_types.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/scene_view.h"

namespace vpm {

// Keeps the tool's level on the device. Belongs to one thread at a time.
class DeviceMeasure {
 public:
  virtual ~DeviceMeasure() = default;

  // Stores the results of `jobs`, whose tools are places in `measures`: this one and others that
  // were made with the same options, except the level. Poses must be exact (tool_query.h). A single
  // job of a single measure takes one launch at most and one wait, and allocates nothing after the
  // first call on a scene; many are cut into launches that fit the device's memory. A cloud is
  // copied to the device when first asked; a frame made for this device lies there already. Throws
  // Error(unavailable) if the device fails.
  virtual void run(const SceneView& scene, std::span<DeviceMeasure* const> measures,
                   std::span<const Job> jobs, std::span<Result> results) = 0;

  // Returns the result of a single job.
  Result run(const SceneView& scene, const Pose& pose) {
    DeviceMeasure* const self = this;
    const Job job{pose, 0};
    Result result;
    run(scene, {&self, 1}, {&job, 1}, {&result, 1});
    return result;
  }

  // Reads the states of the spheres at the last single job.
  virtual void read_states(std::vector<SphereState>& states) = 0;
  // Returns the time of the last single job after the boundary was known, by the device's clock:
  // next to nothing if a camera tells the inside.
  virtual double flood_microseconds() const = 0;
};

// Returns the measure of the options' measure, points and device. On Device::kAll single jobs go to
// the first device. Throws Error(unavailable) in builds without CUDA, or if the device has too
// little memory.
std::unique_ptr<DeviceMeasure> make_device_measure(const ToolModel& tool, const Level& level,
                                                   const QueryOptions& options);

}  // namespace vpm
