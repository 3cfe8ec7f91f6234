#pragma once

#include "libvpm/backend/device_measure.h"

namespace vpm::cuda {

std::unique_ptr<DeviceMeasure> make_refined_measure(const ToolModel& tool, const Level& level,
                                                    const QueryOptions& options, int device);

}  // namespace vpm::cuda
