// Holds the memory of one depth frame: the image, and what is prepared from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>

#include "libvpm/scene/depth_frames.h"
#include "libvpm/scene/frame_preparation.h"

namespace vpm {

class FrameSlot {
 public:
  explicit FrameSlot(const DepthFrameOptions& options)
      : options_(options),
        camera_{options.intrinsics, options.width, options.height, {}},
        preparation_(options.normals, options.points) {}
  virtual ~FrameSlot() = default;
  FrameSlot(const FrameSlot&) = delete;
  FrameSlot& operator=(const FrameSlot&) = delete;

  // Returns the memory for the image, as counts or metres.
  virtual std::byte* image() = 0;
  const std::byte* image() const { return const_cast<FrameSlot*>(this)->image(); }
  std::size_t image_bytes() const {
    return pixels() * (options_.counts_per_metre ? sizeof(std::uint16_t) : sizeof(float));
  }
  std::size_t pixels() const { return std::size_t{options_.width} * options_.height; }

  // Prepares the image in memory, seen from this pose.
  void prepare(const Pose& camera_to_world) {
    camera_ = {options_.intrinsics, options_.width, options_.height, camera_to_world};
    is_prepared_ = false;
    begin();
  }
  // Waits until the image may be overwritten.
  virtual void wait() const {}
  virtual std::size_t points() const { return prepared().positions().size(); }

  const DepthFrameOptions& options() const { return options_; }
  const Camera& camera() const { return camera_; }
  // Returns the image as the CPU prepares it, on the first call.
  const PreparedImage& prepared() const;
  // Returns its surface, in the host's memory; of an image that a device has prepared that one.
  virtual DepthSurface surface() const { return prepared().surface(); }
  // Returns that image's number; 0 if it has not been asked for.
  std::uint64_t serial() const;

 protected:
  virtual void begin() { prepared(); }

 private:
  DepthFrameOptions options_;
  Camera camera_;
  mutable std::mutex mutex_;
  mutable FramePreparation preparation_;
  mutable PreparedImage prepared_;
  mutable bool is_prepared_ = false;
};

// Makes a slot on the CUDA device of the options. Throws Error(unavailable).
std::shared_ptr<FrameSlot> make_device_slot(const DepthFrameOptions& options);

}  // namespace vpm
