// Declares what the library itself asks of devices, beside vpm/device.h.
#pragma once

#include <vpm/device.h>

#include <string>

namespace vpm {

// True if this build of the library can use CUDA devices.
bool is_built_with_cuda();

// Returns name and CUDA version of the driver, e.g. "NVIDIA H100 80GB HBM3, driver 13.0".
std::string cuda_device_name(int index);

}  // namespace vpm
