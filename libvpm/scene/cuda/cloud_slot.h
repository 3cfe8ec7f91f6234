// Holds a depth frame whose cloud is made on a device.
#pragma once

#include <mutex>
#include <optional>

#include "libvpm/device/cuda/runtime.h"
#include "libvpm/scene/cuda/cloud_prepare.h"
#include "libvpm/scene/cuda/device_bodies.h"
#include "libvpm/scene/frame_slot.h"

namespace vpm::cuda {

class CloudSlot : public FrameSlot {
 public:
  explicit CloudSlot(const DepthFrameOptions& options);
  ~CloudSlot() override;

  std::byte* image() override { return image_.host(); }
  void wait() const override;
  std::size_t points() const override;
  DepthSurface surface() const override;

  // Makes work that is launched on the stream next wait for the frame. Thread-safe.
  void require(cudaStream_t stream) const;

  // True if the device makes the cloud. Otherwise the CPU does, since it might refuse something.
  bool is_on_device() const { return is_plain_; }
  // True if the CPU would refuse no point. Waits until all are known.
  bool is_sound() const;

  const DeviceDepthBody& body() const { return body_; }

 protected:
  void begin() override;

 private:
  void launch();
  void take(cudaStream_t stream);
  void make(cudaStream_t stream);
  void set_camera();
  bool is_answered() const;

  Stream stream_;
  MappedArray<std::byte> image_;
  DeviceArray<float> depth_, inverse_;
  DeviceArray<float4> seen_;
  DeviceDepthBody body_;
  DeviceArray<CloudCounters> counters_;
  MappedArray<CloudAnswer> answer_;
  CloudRecipe recipe_;  // for the camera of the image
  Preparation preparation_;
  bool is_plain_ = false;
  Event end_{cudaEventDisableTiming};  // end of the last preparation
  unsigned sequence_ = 0;              // number of the last preparation
  mutable std::mutex mutex_;           // guards what follows
  mutable bool is_there_ = true;       // the last preparation has ended
  mutable std::optional<FetchedImage> fetched_;
  mutable bool is_fetched_ = false;  // `fetched_` holds what that has made
};

}  // namespace vpm::cuda
