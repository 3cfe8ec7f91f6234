#include "libvpm/core/error.h"
#include "libvpm/solid/device_pairs.h"

namespace vpm {

std::unique_ptr<DevicePairs> make_device_pairs(const Device&, std::span<const SurfaceView>) {
  throw Error(ErrorKind::unavailable, "this build of libvpm has no CUDA");
}

}  // namespace vpm
