// One measure on several devices: the poses of a batch are spread over them.
#pragma once

#include "libvpm/query/device_measure.h"

namespace vpm {

class SpreadMeasure : public DeviceMeasure {
 public:
  // At least one, each on a device of its own.
  explicit SpreadMeasure(std::vector<std::unique_ptr<DeviceMeasure>> measures)
      : measures_(std::move(measures)) {}

  // On the first device.
  Result run(const PreparedCloud& cloud, const Pose& pose) override {
    return measures_.front()->run(cloud, pose);
  }
  // A batch goes to all devices, for which the CPU prepares the frame.
  using DeviceMeasure::run_frame;
  Result run_frame(const DepthFrame& frame, const Pose& pose) override {
    return measures_.front()->run_frame(frame, pose);
  }
  void read_states(std::vector<SphereState>& states) override {
    measures_.front()->read_states(states);
  }
  double flood_microseconds() const override { return measures_.front()->flood_microseconds(); }

  // A thread for each device, which takes the next poses that nobody has taken as long as there are
  // any: a device with dear poses takes fewer.
  void run(const PreparedCloud& cloud, std::span<const Pose> poses,
           std::span<Result> results) override;
  void run_together(std::span<DeviceMeasure* const> measures, const PreparedCloud& cloud,
                    std::span<const ToolPose> poses, std::span<Result> results) override;

 private:
  // Calls run(device, begin, count) for parts of so many poses until all are answered.
  template <class Run>
  void deal_out(std::size_t poses, const Run& run);

  std::vector<std::unique_ptr<DeviceMeasure>> measures_;
};

}  // namespace vpm
