#include "libvpm/scene/depth/depth_body.h"

#include "libvpm/scene/frame_slot.h"

namespace vpm {

const Pose& DepthBody::to_world() const {
  return (slot_ ? slot_->camera() : image_->camera()).to_world;
}

std::size_t DepthBody::points() const {
  return slot_ ? slot_->points() : image_->positions().size();
}

std::uint64_t DepthBody::serial() const {
  return slot_ ? slot_->serial() : image_->serial();
}

const PreparedImage& DepthBody::prepared() const {
  return slot_ ? slot_->prepared() : *image_;
}

}  // namespace vpm
