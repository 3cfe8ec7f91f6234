#include "libvpm/core/error.h"
#include "libvpm/scene/frame_slot.h"

namespace vpm {

std::shared_ptr<FrameSlot> make_device_slot(const DepthFrameOptions&) {
  throw Error(ErrorKind::unavailable, "this build has no CUDA");
}

}  // namespace vpm
