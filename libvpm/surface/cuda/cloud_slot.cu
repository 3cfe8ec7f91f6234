#include <algorithm>

#include "libvpm/core/lengths.h"
#include "libvpm/surface/cuda/cloud_settle.h"
#include "libvpm/surface/cuda/cloud_slot.h"

namespace vpm::cuda {
namespace {

// Bounds within which float positions of usable depths are finite and lie on the rays of their
// pixels, their disks are finite, and a cloud has no more points than a PreparedCloud takes: with
// rays `longest` times as long as deep, a position errs by less than 2^-22 of its length.
bool is_plain(const Camera& camera) {
  const Intrinsics& k = camera.intrinsics;
  const double x = std::max(std::abs(k.cx), std::abs(camera.width - 1 - k.cx)) / k.fx;
  const double y = std::max(std::abs(k.cy), std::abs(camera.height - 1 - k.cy)) / k.fy;
  const double longest = std::sqrt(x * x + y * y + 1);
  constexpr double kLongest = 0x1p10, kWidestPixel = 0x1p10, kError = 0x1p-21;
  return std::size_t{camera.width} * camera.height <= PreparedCloud::kMaxPoints &&
         std::max(camera.width, camera.height) <= DepthSurface::kMostPixelsASide &&
         longest <= kLongest && 1 / k.fx <= kWidestPixel && 1 / k.fy <= kWidestPixel &&
         std::max(k.fx, k.fy) * kError * longest * (longest + 1) <= kPixelTolerance / 2;
}

// As validate() and PreparedCloud ask of a camera.
bool is_sound_pose(const Pose& pose) {
  return is_rotation(pose.rotation, kRotationExact) && is_in_range(pose.translation);
}

constexpr std::size_t whole_groups(std::size_t pixels) {
  return (pixels + kMostPixelsAtOnce - 1) / kMostPixelsAtOnce * kMostPixelsAtOnce;
}

Error lost() {
  return Error(ErrorKind::unavailable, "the device has not made the frame; prepare it again");
}

}  // namespace

CloudSlot::CloudSlot(const DepthFrameOptions& options)
    : FrameSlot(options),
      image_(whole_groups(pixels()) * (image_bytes() / pixels())),
      depth_(whole_groups(pixels())),
      inverse_(whole_groups(pixels())),
      seen_(pixels()),
      cloud_(Camera{options.intrinsics, options.width, options.height, {}}),
      counters_(1),
      answer_(1),
      source_(new_source()),
      source_on_device_(&source_, 1),
      preparation_(preparation_of(options.normals)) {
  counters_.clear();
}

CloudSlot::~CloudSlot() {
  cudaEventSynchronize(end_->get());
}

void CloudSlot::begin() {
  is_plain_ = preparation_.fits && is_plain(camera()) && is_sound_pose(camera().to_world);
  if (!is_plain_) {
    cloud();  // refuses what is to be refused
    return;
  }
  cloud_.stand_at(camera().to_world);
  source_.recipe.camera = camera();
  source_.look_from(camera().to_world.rotation);
  made_ = placed_ = {};
  has_failed_ = false;
  if (options().making == FrameMaking::whole) require_all();
}

CloudSlot::Part CloudSlot::require_all() const {
  return require(whole(), stream_.get());
}

CloudSlot::Part CloudSlot::require(const PixelRectangle& pixels, cudaStream_t stream) const {
  const std::lock_guard lock(making_);
  if (has_failed_) throw lost();
  if (!is_there()) check(cudaStreamWaitEvent(stream, end_->get()));
  const PixelRectangle wanted = united(made_, in_whole_tiles(pixels));
  if (!(wanted == made_)) {  // all of it is made with its points
    const CurrentDevice current(options().device.first());
    const OtherWork other;
    launch(wanted, stream);
    other.goes_on_until(end_);
  }
  return {made_, made_ == whole(), is_there_, sequence_};
}

// What is launched has an end, even if the rest fails.
void CloudSlot::launch(const PixelRectangle& wanted, cudaStream_t stream) const {
  const auto mark_end = [&] {
    is_there_ = false;
    return cudaEventRecord(end_->get(), stream);
  };
  has_failed_ = true;
  try {
    take(wanted, stream);
    make(wanted, stream);
  } catch (...) {
    mark_end();
    throw;
  }
  check(mark_end());
  has_failed_ = false;
  made_ = placed_ = wanted;
}

bool CloudSlot::is_there() const {
  is_there_ = is_there_ || has_happened(*end_);
  return is_there_;
}

void CloudSlot::take(const PixelRectangle& wanted, cudaStream_t stream) const {
  take_image(source_.image, source_.taken, source_.recipe,
             pixels_to_take(source_.recipe, {wanted, placed_}), is_empty(made_), source_.counters,
             stream);
}

void CloudSlot::make(const PixelRectangle& wanted, cudaStream_t stream) const {
  prepare_on_device(source_.recipe, pixels_to_prepare(source_.recipe, {wanted, placed_}),
                    options().normals.method, preparation_, source_.counters, source_.answer,
                    sequence_ + 1, stream);
  ++sequence_;  // now that it will be answered
  settle_on_device(source_.recipe, {wanted, made_}, preparation_.overlaps, stream);
}

// Images of which all is asked for are made by kernels that fill the device. What was launched in
// this memory, the query's own kernel would not wait for.
bool CloudSlot::is_for_query(const PixelRectangle& wanted) const {
  return !has_failed_ && !(wanted == made_) && !(wanted == whole()) &&
         is_made_by_queries(options().normals) && is_there();
}

PixelRectangle CloudSlot::whole() const {
  const DepthSurface& surface = cloud_.depth_surface();
  return whole_image(surface.width, surface.height);
}

PixelRectangle CloudSlot::in_whole_tiles(const PixelRectangle& pixels) const {
  const DepthSurface& surface = cloud_.depth_surface();
  return widened(pixels, 0, kTileWidth, kTileHeight, surface.width, surface.height);
}

CloudSource CloudSlot::new_source() {
  const DepthFrameOptions& o = options();
  DepthSource image;
  if (o.counts_per_metre) {
    image.counts = reinterpret_cast<const std::uint16_t*>(image_.device());
    image.counts_per_metre = *o.counts_per_metre;
  } else {
    image.metres = reinterpret_cast<const float*>(image_.device());
  }
  CloudSource source{image,
                     {depth_.get(), inverse_.get()},
                     {depth_.get(),
                      inverse_.get(),
                      camera(),
                      {},
                      pixel_scale_in_floats(o.intrinsics),
                      pixel_scale(o.intrinsics),
                      o.normals.window,
                      EdgeGate(o.normals, o.intrinsics),
                      whole_window(o.normals.window),
                      seen_.get(),
                      o.points,
                      cloud_.room()},
                     counters_.get(),
                     answer_.device()};
  source.look_from(camera().to_world.rotation);
  return source;
}

bool CloudSlot::is_answered(unsigned sequence) const {
  // Numbers begin anew some day.
  const auto is_reached = [&](const NumberedWord& word) {
    return static_cast<std::int32_t>(number_of(look_at(word)) - sequence) >= 0;
  };
  return is_reached(answer_.host()->points) && is_reached(answer_.host()->doubtful);
}

void CloudSlot::wait_for(unsigned sequence) const {
  for (unsigned looks = 1; !is_answered(sequence); ++looks)
    if (looks % kLooksPerCheck == 0 && has_happened(*end_) && !is_answered(sequence)) throw lost();
}

// For all that was launched: the image is not read any more.
void CloudSlot::wait() const {
  if (is_plain_ && !has_failed_) wait_for(sequence_);
}

bool CloudSlot::is_sound(const Part& part) const {
  if (is_empty(part.made)) return true;  // answers are of other frames
  if (!part.is_there) wait_for(part.sequence);
  while (!is_answered(part.sequence)) {  // what has been made has answered: it is on its way
  }
  return value_of(look_at(answer_.host()->doubtful)) == 0;
}

std::size_t CloudSlot::points() const {
  const CurrentDevice current(options().device.first());
  if (is_plain_ && is_sound(require_all())) return value_of(look_at(answer_.host()->points));
  return cloud().positions().size();
}

}  // namespace vpm::cuda

namespace vpm {

std::shared_ptr<FrameSlot> make_device_slot(const DepthFrameOptions& options) {
  const cuda::CurrentDevice current(options.device.first());
  return std::make_shared<cuda::CloudSlot>(options);
}

}  // namespace vpm
