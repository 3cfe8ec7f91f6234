// What takes the place of cuda/ in a build without CUDA.
#include "libvpm/core/error.h"
#include "libvpm/query/device_measure.h"

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

std::unique_ptr<DeviceMeasure> make_device_measure(const ToolModel&, const Level&,
                                                   const QueryOptions&) {
  throw Error(ErrorKind::unavailable, "this build of libvpm has no CUDA");
}

}  // namespace vpm
