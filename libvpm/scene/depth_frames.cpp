#include "libvpm/scene/depth_frames.h"

#include <atomic>
#include <cmath>
#include <cstring>

#include "libvpm/core/error.h"
#include "libvpm/scene/frame_slot.h"

namespace vpm {
namespace {

class HostSlot : public FrameSlot {
 public:
  explicit HostSlot(const DepthFrameOptions& options) : FrameSlot(options), image_(image_bytes()) {}
  std::byte* image() override { return image_.data(); }

 private:
  std::vector<std::byte> image_;
};

DepthImage depth_of(const FrameSlot& slot) {
  const DepthFrameOptions& options = slot.options();
  DepthImage depth{options.width, options.height, std::vector<float>(slot.pixels())};
  if (!options.counts_per_metre) {
    std::memcpy(depth.depth.data(), slot.image(), slot.image_bytes());
    return depth;
  }
  const auto* const counts = reinterpret_cast<const std::uint16_t*>(slot.image());
  for (std::size_t i = 0; i < depth.depth.size(); ++i)
    depth.depth[i] = depth_in_metres(counts[i], *options.counts_per_metre);
  return depth;
}

void check_options(const DepthFrameOptions& options) {
  const auto wrong = [](const std::string& what) {
    throw Error(ErrorKind::invalid_argument, what, "depth frames");
  };
  check_intrinsics(options.intrinsics);
  check_normal_options(options.normals);
  if (options.width == 0 || options.height == 0) wrong("an image has pixels: give its size");
  if (options.counts_per_metre &&
      !(*options.counts_per_metre > 0 && std::isfinite(*options.counts_per_metre)))
    wrong("the counts per metre must be a positive number");
}

}  // namespace

const PreparedImage& FrameSlot::prepared() const {
  const std::lock_guard lock(mutex_);
  if (!is_prepared_) preparation_.prepare(depth_of(*this), camera_, prepared_);
  is_prepared_ = true;
  return prepared_;
}

std::uint64_t FrameSlot::serial() const {
  const std::lock_guard lock(mutex_);
  return is_prepared_ ? prepared_.serial() : 0;
}

DepthFrames::DepthFrames(const DepthFrameOptions& options) : options_(options) {
  check_options(options);
  next();
}

// Returns a slot that nobody holds; makes one if there is none.
FrameSlot& DepthFrames::next() {
  for (std::size_t k = 0; k < slots_.size() && !next_; ++k) {
    if (slots_[k].use_count() == 1) next_ = slots_[k];
  }
  if (!next_) {
    next_ = options_.device.is_cuda() ? make_device_slot(options_)
                                      : std::make_shared<HostSlot>(options_);
    slots_.push_back(next_);
  }
  // Acquire: other threads' last reads of the frame happen before its memory is overwritten.
  std::atomic_thread_fence(std::memory_order_acquire);
  next_->wait();
  return *next_;
}

std::span<std::uint16_t> DepthFrames::counts() {
  if (!options_.counts_per_metre)
    throw Error(ErrorKind::invalid_argument, "these are in metres", "depth frames",
                "write to metres()");
  FrameSlot& slot = next();
  return {reinterpret_cast<std::uint16_t*>(slot.image()), slot.pixels()};
}

std::span<float> DepthFrames::metres() {
  if (options_.counts_per_metre)
    throw Error(ErrorKind::invalid_argument, "these are in counts", "depth frames",
                "write to counts()");
  FrameSlot& slot = next();
  return {reinterpret_cast<float*>(slot.image()), slot.pixels()};
}

DepthBody DepthFrames::prepare(const Pose& camera_to_world) {
  next().prepare(camera_to_world);
  return DepthBody(std::shared_ptr<const FrameSlot>(std::move(next_)));
}

}  // namespace vpm
