// Replaces the files of cuda/ in builds without CUDA.
#include "libvpm/device/device.h"

namespace vpm {

int cuda_device_count() {
  return 0;
}

bool is_built_with_cuda() {
  return false;
}

std::string cuda_device_name(int) {
  return {};
}

}  // namespace vpm
