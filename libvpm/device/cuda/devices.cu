#include "libvpm/device/cuda/runtime.h"
#include "libvpm/device/device.h"

namespace vpm {

int cuda_device_count() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess ? count : 0;
}

bool is_built_with_cuda() {
  return true;
}

std::string cuda_device_name(int index) {
  cudaDeviceProp properties;
  int driver = 0;
  cuda::check(cudaGetDeviceProperties(&properties, index));
  cuda::check(cudaDriverGetVersion(&driver));
  return std::string(properties.name) + ", driver for CUDA " + std::to_string(driver / 1000) + "." +
         std::to_string(driver % 1000 / 10);
}

}  // namespace vpm
