// Prepares a cloud from a depth image with the bits of PreparedCloud(make_cloud(...), points),
// several times as fast: rows go through all steps while they are in the cache, pixels need no
// sorting, and the memory of the last frame is used again.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

#include "libvpm/cloud/normal_rows.h"
#include "libvpm/scene/depth/denoised_image.h"
#include "libvpm/scene/depth_frames.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm {

class FramePreparation {
 public:
  // Throws Error(invalid_argument) for options out of range.
  explicit FramePreparation(const NormalOptions& options, Denoising points = Denoising::on);

  // Makes `cloud` that of the frame, without new memory if it held a frame of the same size; nobody
  // may use it meanwhile. Throws as make_cloud() and PreparedCloud() do; `cloud` is empty then.
  void prepare(const DepthImage& depth, const Camera& camera, PreparedCloud& cloud);

 private:
  void take_camera(const Camera& camera, PreparedCloud& cloud);
  bool prepare_rows(const DepthImage& depth, const Camera& camera, PreparedCloud& cloud);
  void close_ranks(std::size_t width, PreparedCloud& cloud) const;

  NormalOptions options_;
  Denoising points_;
  NormalImages images_;
  ImageSteps steps_;
  std::vector<double> rays_;               // x / z for each column
  std::vector<std::uint32_t> row_points_;  // number of points in each row
};

// Holds the memory of one depth frame: the image, and what is prepared from it.
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
    has_cloud_ = false;
    begin();
  }
  // Waits until the image may be overwritten.
  virtual void wait() const {}
  virtual std::size_t points() const { return cloud().positions().size(); }

  const DepthFrameOptions& options() const { return options_; }
  const Camera& camera() const { return camera_; }
  // Returns the cloud as the CPU prepares it, on the first call.
  const PreparedCloud& cloud() const;

 protected:
  virtual void begin() { cloud(); }

 private:
  DepthFrameOptions options_;
  Camera camera_;
  mutable std::mutex mutex_;
  mutable FramePreparation preparation_;
  mutable PreparedCloud cloud_{Cloud{}};
  mutable bool has_cloud_ = false;
};

// Makes a slot on the CUDA device of the options. Throws Error(unavailable).
std::shared_ptr<FrameSlot> make_device_slot(const DepthFrameOptions& options);

}  // namespace vpm
