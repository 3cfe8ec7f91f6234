// A depth frame whose cloud lies on a device.
#pragma once

#include <mutex>

#include "libvpm/query/cuda/cloud_prepare.h"
#include "libvpm/query/cuda/launch.h"
#include "libvpm/query/cuda/on_device.h"
#include "libvpm/query/frame_slot.h"

namespace vpm::cuda {

class CloudSlot : public FrameSlot {
 public:
  explicit CloudSlot(const DepthFrameOptions& options);
  ~CloudSlot() override;

  std::byte* image() override { return image_.host(); }
  void wait() const override;
  std::size_t points() const override;

  // What a query may read.
  struct Part {
    PixelRectangle made;
    bool is_whole = true;
    bool is_there = true;  // its making has ended
  };
  // These pixels, and what was made before, for what is launched on the stream next. What was not
  // made is launched there. From any thread.
  Part require(const PixelRectangle& pixels, cudaStream_t stream) const;

  // Whether the device makes the cloud. Otherwise the CPU does, since it might refuse something.
  bool is_on_device() const { return is_plain_; }
  // Whether that has no point that the CPU might refuse. Waits for it.
  bool is_sound() const {
    wait();
    return doubtful() == 0;
  }

  const DeviceCloud& device_cloud() const { return cloud_; }

  // Of the image, in camera axes, whether the cloud can be made here or not.
  std::vector<Vec3f> estimate_normals();

  // The two steps in which tiles are made, for those who time them.
  void take(const TileRectangle& wanted, cudaStream_t stream) const;
  void make(const TileRectangle& wanted, cudaStream_t stream, Vec3f* estimated = nullptr) const;
  TileRectangle all_tiles() const;

 protected:
  void begin() override;

 private:
  Part require_all() const;
  bool is_there() const;
  CloudRecipe recipe() const;
  TileRectangle with_neighbors(const TileRectangle& tiles) const;
  PixelRectangle pixels_of(const TileRectangle& tiles) const;
  bool is_answered(unsigned sequence) const;
  unsigned doubtful() const;

  Stream stream_;
  MappedArray<std::byte> image_;
  DeviceArray<float> depth_, inverse_;
  DeviceArray<Vec3f> seen_;
  DeviceCloud cloud_;
  DeviceArray<CloudCounters> counters_;
  MappedArray<CloudAnswer> answer_;
  Preparation preparation_;
  bool is_plain_ = false;
  std::shared_ptr<Event> end_ = std::make_shared<Event>(cudaEventDisableTiming);  // of all making
  mutable std::mutex making_;                                                     // of what follows
  mutable TileRectangle made_;
  mutable bool is_there_ = true;
  mutable unsigned sequence_ = 0;
};

}  // namespace vpm::cuda
