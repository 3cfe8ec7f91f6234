// Measures on CUDA devices, with the bits of RefinedMeasure.
#pragma once

#include <vpm/device_batch.h>
#include <vpm/query_types.h>

#include <memory>
#include <span>
#include <vector>

#include "libvpm/measure/body_sum.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/any_body.h"

namespace vpm {

// Answers in a device's memory. Has the contract of DeviceResults.
class ResidentAnswers {
 public:
  virtual ~ResidentAnswers() = default;
  virtual std::size_t size() const = 0;
  virtual Device device() const = 0;
  virtual const DeviceResult* rows() const = 0;
  virtual void wait_in(void* stream) const = 0;
  virtual void wait() const = 0;
};

// Keeps a tool's level on the device. Belongs to one thread at a time.
class DeviceMeasure {
 public:
  virtual ~DeviceMeasure() = default;

  // Stores what a body gives for each of `jobs`, whose tools are indices into `measures`: this one
  // and others made with the same options save the level. A single job of a single measure takes at
  // most one launch and one wait, and allocates nothing after the first call on a body; batches are
  // cut to the device's memory. Copies a body to the device on its first use; a frame made for it
  // lies there already. Throws Error(unavailable) if the device fails.
  virtual void run(const AnyBody& body, std::span<DeviceMeasure* const> measures,
                   std::span<const BodyJob> jobs, std::span<BodySum> sums) = 0;

  // Begins to answer poses on the device before a scene's bodies, for a stiffness of N/m^3. Has the
  // contract of Query::run.
  virtual std::shared_ptr<const ResidentAnswers> begin(std::span<const AnyBody> scene,
                                                       const DevicePoses& poses,
                                                       double stiffness) = 0;

  // Returns what a body gives for a single job.
  BodySum run(const AnyBody& body, const Pose& to_body) {
    DeviceMeasure* const self = this;
    const BodyJob job{to_body, 0};
    BodySum sum;
    run(body, {&self, 1}, {&job, 1}, {&sum, 1});
    return sum;
  }

  // Gives back the copies of bodies that are not in this scene.
  virtual void keep_only(std::span<const AnyBody> scene) = 0;

  // Reads the states of the spheres at the last single job, one per sphere.
  virtual void read_states(std::vector<SphereState>& states) = 0;
  // Returns the device time, us, of the last single job after the boundary was known; nearly 0
  // where a camera tells the inside.
  virtual double flood_microseconds() const = 0;
};

// Makes the refined measure. On Device::kAll single jobs go to the first device.
// Throws Error(unavailable) in builds without CUDA, or if the device has too little memory.
std::unique_ptr<DeviceMeasure> make_device_measure(const ToolModel& tool, const Level& level,
                                                   const QueryOptions& options);

// Spreads the jobs of a batch over several devices.
class SpreadMeasure : public DeviceMeasure {
 public:
  // Takes at least one measure, each on its own device.
  explicit SpreadMeasure(std::vector<std::unique_ptr<DeviceMeasure>> measures)
      : measures_(std::move(measures)) {}

  // Leaves a single job to the first device. For a batch, a thread for each device takes jobs as
  // long as any are left. All `measures` must spread over the same devices.
  void run(const AnyBody& body, std::span<DeviceMeasure* const> measures,
           std::span<const BodyJob> jobs, std::span<BodySum> sums) override;

  // Leaves poses on a device to the first one.
  std::shared_ptr<const ResidentAnswers> begin(std::span<const AnyBody> scene,
                                               const DevicePoses& poses,
                                               double stiffness) override {
    return measures_.front()->begin(scene, poses, stiffness);
  }

  void keep_only(std::span<const AnyBody> scene) override {
    for (const auto& measure : measures_) measure->keep_only(scene);
  }
  void read_states(std::vector<SphereState>& states) override {
    measures_.front()->read_states(states);
  }
  double flood_microseconds() const override { return measures_.front()->flood_microseconds(); }

 private:
  std::vector<std::unique_ptr<DeviceMeasure>> measures_;
};

}  // namespace vpm
