// Spreads the jobs of a batch over several devices.
#pragma once

#include "libvpm/backend/device_measure.h"

namespace vpm {

class SpreadMeasure : public DeviceMeasure {
 public:
  // Takes at least one measure, each on its own device.
  explicit SpreadMeasure(std::vector<std::unique_ptr<DeviceMeasure>> measures)
      : measures_(std::move(measures)) {}

  // Leaves a single job to the first device. A batch is prepared on the CPU, and a thread for each
  // device takes jobs as long as any are left. All `measures` must spread over the same devices.
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
