#include <algorithm>
#include <atomic>
#include <cstring>

#include "libvpm/core/lengths.h"
#include "libvpm/query/cuda/cloud_settle.h"
#include "libvpm/query/cuda/cloud_slot.h"

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
  return is_rotation(pose.rotation, kCameraRotationTolerance) && is_in_range(pose.translation);
}

constexpr std::size_t whole_groups(std::size_t pixels) {
  return (pixels + kPixelsAtOnce - 1) / kPixelsAtOnce * kPixelsAtOnce;
}

std::uint64_t next_serial() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

CloudSlot::CloudSlot(const DepthFrameOptions& options)
    : FrameSlot(options),
      image_(whole_groups(pixels()) * (image_bytes() / pixels()) / sizeof(uint4)),
      depth_(whole_groups(pixels())),
      inverse_(whole_groups(pixels())),
      seen_(pixels()),
      cloud_(Camera{options.intrinsics, options.width, options.height, {}}),
      counters_(1),
      answer_(1),
      preparation_(preparation_of(options.normals)) {
  counters_.clear();
}

CloudSlot::~CloudSlot() {
  cudaStreamSynchronize(stream_.get());
}

void CloudSlot::begin() {
  const CurrentDevice current(options().device.first());
  is_plain_ = preparation_.fits && is_plain(camera()) && is_sound_pose(camera().to_world);
  serial_ = next_serial();
  if (!is_plain_) {
    cloud();  // refuses what is to be refused
    return;
  }
  cloud_.stand_at(camera().to_world);
  const OtherWork other;
  take(stream_.get());
  make(stream_.get());
  check(cudaEventRecord(ready_->get(), stream_.get()));
  other.goes_on_until(ready_);
}

void CloudSlot::take(cudaStream_t stream) {
  DepthSource source;
  if (options().counts_per_metre) {
    source.counts = reinterpret_cast<const std::uint16_t*>(image_.device());
    source.counts_per_metre = *options().counts_per_metre;
  } else {
    source.metres = reinterpret_cast<const float*>(image_.device());
  }
  take_image(source, depth_.get(), inverse_.get(), pixels(), cloud_.room(), camera(), stream);
}

void CloudSlot::make(cudaStream_t stream, Vec3f* estimated) {
  CloudRecipe from_image = recipe();
  from_image.room.estimated = estimated;
  prepare_on_device(from_image, options().normals.method, preparation_, counters_.get(),
                    answer_.device(), sequence_ + 1, stream);
  ++sequence_;  // now that it will be answered
  settle_on_device(from_image, preparation_.overlaps, stream);
}

std::vector<Vec3f> CloudSlot::estimate_normals() {
  const CurrentDevice current(options().device.first());
  const DeviceArray<Vec3f> estimated(pixels());
  const OtherWork other;
  take(stream_.get());
  make(stream_.get(), estimated.get());
  check(cudaStreamSynchronize(stream_.get()));
  std::vector<Vec3f> normals(pixels());
  check(cudaMemcpy(normals.data(), estimated.get(), normals.size() * sizeof(Vec3f),
                   cudaMemcpyDeviceToHost));
  return normals;
}

CloudRecipe CloudSlot::recipe() const {
  const DepthFrameOptions& o = options();
  const Pose& to_world = camera().to_world;
  return {depth_.get(),
          inverse_.get(),
          camera(),
          relative_to(to_world, {{}, to_world.translation}).rotation,
          1 / o.intrinsics.fx,
          1 / o.intrinsics.fy,
          o.normals.window,
          EdgeGate(o.normals, o.intrinsics),
          WholeWindow(o.normals.window),
          seen_.get(),
          o.points,
          cloud_.room()};
}

bool CloudSlot::is_answered() const {
  const auto* const answer = static_cast<const volatile CloudAnswer*>(answer_.host());
  return answer->points >> 32 == sequence_ && answer->doubtful >> 32 == sequence_;
}

unsigned CloudSlot::doubtful() const {
  return static_cast<unsigned>(static_cast<const volatile CloudAnswer*>(answer_.host())->doubtful);
}

void CloudSlot::wait() const {
  if (!is_plain_) return;
  for (unsigned looks = 1; !is_answered(); ++looks) {
    if (looks % kLooksPerCheck != 0) continue;
    if (is_done(cudaStreamQuery(stream_.get())) && !is_answered())
      throw Error(ErrorKind::unavailable, "the device has not made the frame; prepare it again");
  }
}

std::size_t CloudSlot::points() const {
  wait();
  if (!is_plain_ || !is_sound()) return cloud().positions().size();
  return static_cast<std::uint32_t>(
      static_cast<const volatile CloudAnswer*>(answer_.host())->points);
}

}  // namespace vpm::cuda

namespace vpm {

std::vector<Vec3f> estimate_on_device(const DepthImage& depth, const Intrinsics& intrinsics,
                                      const NormalOptions& options, const Device& device) {
  const cuda::CurrentDevice current(device.first());
  if (!cuda::preparation_of(options).fits) return estimate_normals(depth, intrinsics, options);
  cuda::CloudSlot slot({intrinsics, depth.width, depth.height, std::nullopt, options, device});
  std::memcpy(slot.image(), depth.depth.data(), slot.image_bytes());
  return slot.estimate_normals();
}

std::shared_ptr<FrameSlot> make_device_slot(const DepthFrameOptions& options) {
  const cuda::CurrentDevice current(options.device.first());
  return std::make_shared<cuda::CloudSlot>(options);
}

}  // namespace vpm
