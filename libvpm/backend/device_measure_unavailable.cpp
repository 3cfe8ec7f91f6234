#include "libvpm/backend/device_measure.h"
#include "libvpm/core/error.h"

namespace vpm {

std::unique_ptr<DeviceMeasure> make_device_measure(const ToolModel&, const Level&,
                                                   const QueryOptions&) {
  throw Error(ErrorKind::unavailable, "this build of libvpm has no CUDA");
}

}  // namespace vpm
