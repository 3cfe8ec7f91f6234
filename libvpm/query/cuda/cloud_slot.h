// A depth frame whose cloud lies on a device.
#pragma once

#include "libvpm/query/cuda/cloud_prepare.h"
#include "libvpm/query/cuda/launch.h"
#include "libvpm/query/cuda/on_device.h"
#include "libvpm/query/frame_slot.h"

namespace vpm::cuda {

class CloudSlot : public FrameSlot {
 public:
  explicit CloudSlot(const DepthFrameOptions& options);
  ~CloudSlot() override;

  std::byte* image() override { return reinterpret_cast<std::byte*>(image_.host()); }
  void wait() const override;
  std::size_t points() const override;

  // Different for any two frames of a process.
  std::uint64_t serial() const { return serial_; }
  // Whether the device makes the cloud. Otherwise the CPU does, since it might refuse something.
  bool is_on_device() const { return is_plain_; }
  // Whether that has no point that the CPU might refuse. Waits for it.
  bool is_sound() const {
    wait();
    return doubtful() == 0;
  }

  const DeviceCloud& device_cloud() const { return cloud_; }
  const Event& ready() const { return *ready_; }

  // Of the image, in camera axes, whether the cloud can be made here or not.
  std::vector<Vec3f> estimate_normals();

  // The two steps of begin(), for those who time them.
  void take(cudaStream_t stream);
  void make(cudaStream_t stream, Vec3f* estimated = nullptr);

 protected:
  void begin() override;

 private:
  CloudRecipe recipe() const;
  bool is_answered() const;
  unsigned doubtful() const;

  Stream stream_;
  MappedArray<uint4> image_;
  DeviceArray<float> depth_, inverse_;
  DeviceArray<Vec3f> seen_;
  DeviceCloud cloud_;
  DeviceArray<CloudCounters> counters_;
  MappedArray<CloudAnswer> answer_;
  std::shared_ptr<Event> ready_ = std::make_shared<Event>(cudaEventDisableTiming);
  Preparation preparation_;
  bool is_plain_ = false;
  unsigned sequence_ = 0;
  std::uint64_t serial_ = 0;
};

}  // namespace vpm::cuda
