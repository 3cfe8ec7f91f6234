#include "libvpm/core/error.h"
#include "libvpm/query/device_measure.h"

namespace vpm {

std::unique_ptr<DeviceMeasure> make_device_measure(const ToolModel&, const Level&,
                                                   const QueryOptions&) {
  throw Error(ErrorKind::unavailable, "this build of libvpm has no CUDA");
}

}  // namespace vpm
