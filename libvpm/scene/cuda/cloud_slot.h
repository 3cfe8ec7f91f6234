// A depth frame whose cloud lies on a device.
#pragma once

#include <mutex>

#include "libvpm/device/cuda/stream.h"
#include "libvpm/scene/cuda/cloud_take.h"
#include "libvpm/scene/cuda/device_cloud.h"
#include "libvpm/scene/frame_slot.h"

namespace vpm::cuda {

class CloudSlot : public FrameSlot {
 public:
  explicit CloudSlot(const DepthFrameOptions& options);
  ~CloudSlot() override;

  std::byte* image() override { return image_.host(); }
  void wait() const override;
  std::size_t points() const override;

  // Lets what is launched on the stream next read the frame. Returns true if it is there already,
  // so that nothing waits for it. From any thread.
  bool require(cudaStream_t stream) const;

  // True if the device makes the cloud. Otherwise the CPU does, since it might refuse something.
  bool is_on_device() const { return is_plain_; }
  // True if the CPU would refuse none of its points. Waits until they are known.
  bool is_sound() const;

  const DeviceCloud& device_cloud() const { return cloud_; }

  // The two steps in which the frame is made, for those who time them.
  void take(cudaStream_t stream);
  void make(cudaStream_t stream);

 protected:
  void begin() override;

 private:
  void launch();
  void set_camera();
  bool is_answered() const;
  void wait_for_answer() const;

  Stream stream_;
  MappedArray<std::byte> image_;
  DeviceArray<float> depth_, inverse_;
  DeviceArray<float4> seen_;
  DeviceCloud cloud_;
  DeviceArray<CloudCounters> counters_;
  MappedArray<CloudAnswer> answer_;
  CloudRecipe recipe_;  // seen from the camera of the image
  Preparation preparation_;
  bool is_plain_ = false;
  Event end_{cudaEventDisableTiming};  // of the making
  unsigned sequence_ = 0;              // of the last making
  mutable std::mutex mutex_;           // of is_there_
  mutable bool is_there_ = true;       // what was launched in this memory has ended
};

}  // namespace vpm::cuda
