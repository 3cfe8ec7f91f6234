#pragma once

#include "libvpm/backend/device_measure.h"

namespace vpm::cuda {

std::unique_ptr<DeviceMeasure> make_paper_measure(const ToolModel& tool, const Level& level,
                                                  int device);

}  // namespace vpm::cuda
