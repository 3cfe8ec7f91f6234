#include "libvpm/core/lengths.h"
#include "libvpm/scene/cuda/cloud_prepare.h"
#include "libvpm/scene/cuda/cloud_slot.h"

namespace vpm::cuda {
namespace {

constexpr std::size_t whole_groups(std::size_t pixels) {
  return (pixels + kPixelsAtOnce - 1) / kPixelsAtOnce * kPixelsAtOnce;
}

}  // namespace

CloudSlot::CloudSlot(const DepthFrameOptions& options)
    : FrameSlot(options),
      image_(whole_groups(pixels()) * (image_bytes() / pixels())),
      depth_(whole_groups(pixels())),
      inverse_(whole_groups(pixels())),
      seen_(pixels()),
      body_(Camera{options.intrinsics, options.width, options.height, {}}),
      counters_(1),
      answer_(1),
      recipe_{depth_.get(),
              inverse_.get(),
              {},
              {},
              pixel_scale_in_floats(options.intrinsics),
              pixel_scale(options.intrinsics),
              options.normals.window,
              EdgeGate(options.normals, options.intrinsics),
              whole_window(options.normals.window),
              seen_.get(),
              options.points,
              body_.room()},
      preparation_(preparation_of(options.normals)) {
  counters_.clear();
  set_camera();
}

CloudSlot::~CloudSlot() {
  cudaEventSynchronize(end_.get());
}

void CloudSlot::set_camera() {
  recipe_.camera = camera();
  recipe_.to_camera = relative_to({camera().to_world.rotation, {}}, {}).rotation;
}

void CloudSlot::begin() {
  is_fetched_ = false;
  const auto& [rotation, translation] = camera().to_world;  // as PreparedImage accepts it
  is_plain_ = preparation_.fits && is_usual(camera()) && is_rotation(rotation, kRotationExact) &&
              is_in_range(translation);
  if (!is_plain_) {
    prepared();  // throws what is to be refused
    return;
  }
  set_camera();
  const CurrentDevice current(options().device.first());
  launch();
}

// Launches the preparation, and marks its end even if a launch fails.
void CloudSlot::launch() {
  const auto mark_end = [&] {
    is_there_ = false;
    return cudaEventRecord(end_.get(), stream_.get());
  };
  try {
    take(stream_.get());
    make(stream_.get());
  } catch (...) {
    mark_end();
    throw;
  }
  check(mark_end());
}

void CloudSlot::require(cudaStream_t stream) const {
  const std::lock_guard lock(mutex_);
  is_there_ = is_there_ || has_happened(end_);
  if (!is_there_) check(cudaStreamWaitEvent(stream, end_.get()));
}

void CloudSlot::take(cudaStream_t stream) {
  const DepthFrameOptions& o = options();
  DepthSource image;
  if (o.counts_per_metre) {
    image.counts = reinterpret_cast<const std::uint16_t*>(image_.device());
    image.counts_per_metre = *o.counts_per_metre;
  } else {
    image.metres = reinterpret_cast<const float*>(image_.device());
  }
  take_image(image, recipe_, counters_.get(), stream);
}

void CloudSlot::make(cudaStream_t stream) {
  prepare_on_device(recipe_, options().normals.method, preparation_, counters_.get(),
                    answer_.device(), sequence_ + 1, stream);
  ++sequence_;  // after the launch, which will answer it
  denoise_on_device(recipe_, preparation_.overlaps, stream);
}

bool CloudSlot::is_answered() const {
  return number_of(poll(answer_.host()->points)) == sequence_ &&
         number_of(poll(answer_.host()->doubtful)) == sequence_;
}

void CloudSlot::wait() const {
  for (unsigned looks = 1; !is_answered(); ++looks)
    if (looks % kLooksPerCheck == 0 && has_happened(end_) && !is_answered())
      throw Error(ErrorKind::unavailable, "the device has not made the frame; prepare it again");
}

bool CloudSlot::is_sound() const {
  wait();
  return value_of(poll(answer_.host()->doubtful)) == 0;
}

std::size_t CloudSlot::points() const {
  if (is_plain_ && is_sound()) return value_of(poll(answer_.host()->points));
  return prepared().positions().size();
}

DepthSurface CloudSlot::surface() const {
  if (!is_plain_ || !is_sound()) return prepared().surface();
  const std::lock_guard lock(mutex_);
  if (!is_fetched_) {
    const CurrentDevice current(options().device.first());
    if (!fetched_) fetched_.emplace(body_);
    fetched_->fetch(stream_.get());
    check(cudaStreamSynchronize(stream_.get()));
    is_fetched_ = true;
  }
  return fetched_->surface();
}

}  // namespace vpm::cuda

namespace vpm {

std::shared_ptr<FrameSlot> make_device_slot(const DepthFrameOptions& options) {
  const cuda::CurrentDevice current(options.device.first());
  return std::make_shared<cuda::CloudSlot>(options);
}

}  // namespace vpm
