// A depth frame whose cloud lies on a device.
#pragma once

#include <mutex>

#include "libvpm/device/cuda/other_work.h"
#include "libvpm/device/cuda/stream.h"
#include "libvpm/surface/cuda/cloud_part.h"
#include "libvpm/surface/cuda/device_cloud.h"
#include "libvpm/surface/frame_slot.h"

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
    bool is_there = true;  // nothing that was launched is to be waited for
    unsigned sequence = 0;
  };
  // These pixels, and what was made before, for what is launched on the stream next. What was not
  // made is launched there. From any thread. Where a launch fails, the frame is lost.
  Part require(const PixelRectangle& pixels, cudaStream_t stream) const;

  // The same by a query that makes what it reads (cloud_part.h), `most` pixels at most: calls
  // ask(part, making), which returns when that is answered; where it throws, nothing was made, or
  // the device is lost. Whoever asks anything of the frame waits meanwhile. False, and nothing is
  // done, where all is there, or must be required.
  struct Making {
    const CloudSource& source;
    const CloudSource* on_device;  // the same, but for the camera's pose
    NewPart part;
  };
  template <class Ask>
  bool make_by_query(const PixelRectangle& pixels, std::int64_t most, const Ask& ask) const {
    const std::lock_guard lock(making_);
    const PixelRectangle wanted = united(made_, in_whole_tiles(pixels));
    if (pixel_count(wanted) - pixel_count(made_) > most || !is_for_query(wanted)) return false;
    const NewPart part{wanted, made_, sequence_ + 1};
    ask(Part{wanted, false, true, part.sequence}, Making{source_, source_on_device_.get(), part});
    ++sequence_;
    made_ = wanted;
    return true;
  }

  // Whether the device makes the cloud. Otherwise the CPU does, since it might refuse something.
  bool is_on_device() const { return is_plain_; }
  // Whether no point that the CPU might refuse was made so far. Waits for the part.
  bool is_sound(const Part& part) const;
  // Whether queries have made some of it, which has no points so far.
  bool has_part_of_queries() const {
    const std::lock_guard lock(making_);
    return !(made_ == placed_);
  }

  const DeviceCloud& device_cloud() const { return cloud_; }

  // The two steps in which whole tiles are made, for those who time them.
  void take(const PixelRectangle& wanted, cudaStream_t stream) const;
  void make(const PixelRectangle& wanted, cudaStream_t stream) const;
  PixelRectangle whole() const;

 protected:
  void begin() override;

 private:
  Part require_all() const;
  void launch(const PixelRectangle& wanted, cudaStream_t stream) const;
  bool is_there() const;
  CloudSource new_source();
  bool is_for_query(const PixelRectangle& wanted) const;
  PixelRectangle in_whole_tiles(const PixelRectangle& pixels) const;
  bool is_answered(unsigned sequence) const;
  void wait_for(unsigned sequence) const;

  Stream stream_;
  MappedArray<std::byte> image_;
  DeviceArray<float> depth_, inverse_;
  DeviceArray<float4> seen_;
  DeviceCloud cloud_;
  DeviceArray<CloudCounters> counters_;
  MappedArray<CloudAnswer> answer_;
  CloudSource source_;  // seen from the camera of the image
  DeviceArray<CloudSource> source_on_device_;
  Preparation preparation_;
  bool is_plain_ = false;
  std::shared_ptr<Event> end_ = std::make_shared<Event>(cudaEventDisableTiming);  // of all making
  mutable std::mutex making_;                                                     // of what follows
  mutable PixelRectangle made_;      // whole tiles: the surface,
  mutable PixelRectangle placed_;    // and points as well
  mutable bool is_there_ = true;     // what was launched in this memory has ended, of any frame
  mutable bool has_failed_ = false;  // some of it was not launched
  mutable unsigned sequence_ = 0;    // of the last making
};

}  // namespace vpm::cuda
