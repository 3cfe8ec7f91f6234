#include <algorithm>

#include "libvpm/backend/cuda/measure_on_device.h"
#include "libvpm/backend/device_measure.h"
#include "libvpm/device/cuda/device_array.h"

namespace vpm {

namespace {

std::unique_ptr<DeviceMeasure> make_on_one(const ToolModel& tool, const Level& level,
                                           const QueryOptions& options, int device) {
  return options.measure == Measure::paper
             ? cuda::make_paper_measure(tool, level, device)
             : cuda::make_refined_measure(tool, level, options, device);
}

}  // namespace

std::unique_ptr<DeviceMeasure> make_device_measure(const ToolModel& tool, const Level& level,
                                                   const QueryOptions& options) {
  const Device& device = options.device;
  const int count = device.index == Device::kAll ? std::max(1, cuda_device_count()) : 1;
  std::vector<std::unique_ptr<DeviceMeasure>> measures;
  for (int k = 0; k < count; ++k)
    measures.push_back(make_on_one(tool, level, options, device.first() + k));
  if (measures.size() == 1) return std::move(measures.front());
  return std::make_unique<SpreadMeasure>(std::move(measures));
}

}  // namespace vpm
