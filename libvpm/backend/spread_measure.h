// One measure on several devices: the jobs of a batch are spread over them.
#pragma once

#include "libvpm/backend/device_measure.h"

namespace vpm {

class SpreadMeasure : public DeviceMeasure {
 public:
  // Needs at least one measure, each on a device of its own.
  explicit SpreadMeasure(std::vector<std::unique_ptr<DeviceMeasure>> measures)
      : measures_(std::move(measures)) {}

  // Leaves a single job to the first device. For more the CPU prepares a frame, and a thread for
  // each device takes the next jobs that are left, so a device with slow ones takes fewer.
  // `measures` must be SpreadMeasures over the same devices.
  void run(const SceneView& scene, std::span<DeviceMeasure* const> measures,
           std::span<const Job> jobs, std::span<Result> results) override;

  void read_states(std::vector<SphereState>& states) override {
    measures_.front()->read_states(states);
  }
  double flood_microseconds() const override { return measures_.front()->flood_microseconds(); }

 private:
  std::vector<std::unique_ptr<DeviceMeasure>> measures_;
};

}  // namespace vpm
