#include "libvpm/scene/depth/depth_body.h"

#include <mutex>

#include "libvpm/scene/frame_slot.h"
#include "libvpm/scene/rig/silhouettes.h"

namespace vpm {

struct SharedSilhouettes {
  std::once_flag once, once_spread;
  ImageSilhouettes found;
};

DepthBody::DepthBody(PreparedImage image)
    : image_(std::make_shared<const PreparedImage>(std::move(image))),
      silhouettes_(std::make_shared<SharedSilhouettes>()) {}

DepthBody::DepthBody(std::shared_ptr<const FrameSlot> slot)
    : slot_(std::move(slot)), silhouettes_(std::make_shared<SharedSilhouettes>()) {}

const Camera& DepthBody::camera() const {
  return slot_ ? slot_->camera() : image_->camera();
}

DepthSurface DepthBody::surface() const {
  return slot_ ? slot_->surface() : image_->surface();
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

const ImageSilhouettes& DepthBody::silhouettes() const {
  std::call_once(silhouettes_->once, [&] { silhouettes_->found = ImageSilhouettes(surface()); });
  return silhouettes_->found;
}

const ImageSilhouettes& DepthBody::spread_silhouettes() const {
  silhouettes();
  std::call_once(silhouettes_->once_spread, [&] { silhouettes_->found.spread(surface()); });
  return silhouettes_->found;
}

}  // namespace vpm
