#include <algorithm>

#include "libvpm/query/cuda/measure_on_device.h"

namespace vpm::cuda {

// One pose may be answered without a word to the driver: who talks to it makes the device the
// current one.
Result MeasureOnDevice::run(const PreparedCloud& cloud, const Pose& pose) {
  bring(cloud);
  return ask(pose);
}

void MeasureOnDevice::run(const PreparedCloud& cloud, std::span<const Pose> poses,
                          std::span<Result> results) {
  bring(cloud);
  ask(poses, results);
}

Result MeasureOnDevice::run_frame(const DepthFrame& frame, const Pose& pose) {
  if (const CloudSlot* const slot = bring(frame)) {
    const Result result = ask(pose);
    if (slot->is_sound(part_)) return result;
  }
  return run(frame.cloud(), pose);
}

void MeasureOnDevice::run_frame(const DepthFrame& frame, std::span<const Pose> poses,
                                std::span<Result> results) {
  if (const CloudSlot* const slot = bring(frame)) {
    ask(poses, results);
    if (slot->is_sound(part_)) return;
  }
  run(frame.cloud(), poses, results);
}

Result MeasureOnDevice::ask(const Pose& pose) {
  const PoseFrame frame = frame_of(pose, cloud_->frame(), tool_.center_of_mass, reach());
  RawResult raw = frame_ == nullptr ? answer(frame) : answer_in_frame(frame, pixels_read(frame));
  if (raw.beyond != 0) raw = answer_in_frame(frame, all_pixels());
  flood_microseconds_ = 1e-3 * raw.flood_ns;
  return result_of(raw, tool_, pose.rotation);
}

RawResult MeasureOnDevice::answer_in_frame(const PoseFrame& frame, const PixelRectangle& pixels) {
  RawResult raw;
  const bool is_made = frame_->make_by_query(pixels, most_pixels_made(),
                                             [&](const auto& part, const Making& making) {
                                               part_ = part;
                                               raw = answer(frame, &making);
                                             });
  if (is_made) return raw;
  part_ = frame_->require(pixels, stream());
  return answer(frame);
}

RawResult MeasureOnDevice::answer_standing_by(const void* launch, const PoseFrame& frame,
                                              const Making* making, unsigned sequence) {
  Order order;
  order.launch = launch;
  order.to_surface = frame.to_surface;
  order.part.wanted = part_.is_whole ? all_pixels() : part_.made;
  if (making != nullptr) {
    order.image = making->on_device;
    order.camera_to_world = making->source.recipe.camera.to_world.rotation;
    order.part = making->part;
  }
  order.turn = sequence;
  order.waits_us = standby_us_;
  return standby_->ask(order, *answer_.host(), sequence);
}

RawResult MeasureOnDevice::answer(const PoseFrame& frame, const Making* making) {
  const unsigned sequence = sequence_ + 1;
  if (standby_ && part_.is_there) {  // otherwise the stream comes to it
    if (const void* const launch = standing_launch(answer_.device())) {
      end_launched();
      const RawResult raw = answer_standing_by(launch, frame, making, sequence);
      sequence_ = sequence;
      return raw;
    }
  }
  const CurrentDevice current(device_);
  const OtherWork other;
  has_launched_ = true;
  launch(frame, making, answer_.device(), sequence);
  sequence_ = sequence;
  return wait_for(*answer_.host(), sequence, stream_.get(), [] {});
}

void MeasureOnDevice::end_launched() {
  if (!has_launched_) return;
  check(cudaStreamSynchronize(stream_.get()));
  has_launched_ = false;
}

void MeasureOnDevice::ask(std::span<const Pose> poses, std::span<Result> results) {
  const CurrentDevice current(device_);
  if (!batch_) batch_ = std::make_unique<Batch>();
  const OtherWork other;
  if (frame_ != nullptr) part_ = frame_->require(all_pixels(), stream());
  for (std::size_t begin = 0; begin < poses.size(); begin += Batch::kPoses) {
    const std::size_t count = std::min(Batch::kPoses, poses.size() - begin);
    check(cudaMemcpyAsync(batch_->poses.get(), poses.data() + begin, count * sizeof(Pose),
                          cudaMemcpyHostToDevice, stream_.get()));
    launch(batch_->poses.get(), static_cast<unsigned>(count), batch_->results.get());
    check(cudaMemcpyAsync(batch_->answers.data(), batch_->results.get(), count * sizeof(RawResult),
                          cudaMemcpyDeviceToHost, stream_.get()));
    check(cudaStreamSynchronize(stream_.get()));
    for (std::size_t k = 0; k < count; ++k)
      results[begin + k] = result_of(batch_->answers[k], tool_, poses[begin + k].rotation);
  }
}

void MeasureOnDevice::read_states(std::vector<SphereState>& states) {
  const CurrentDevice current(device_);
  check(cudaStreamSynchronize(stream_.get()));
  std::vector<std::uint32_t> words(states.size());
  check(cudaMemcpy(words.data(), state_words(sequence_), words.size() * sizeof(std::uint32_t),
                   cudaMemcpyDeviceToHost));
  std::transform(words.begin(), words.end(), states.begin(),
                 [&](std::uint32_t word) { return state_of(word); });
}

void MeasureOnDevice::bring(const PreparedCloud& cloud) {
  if (!copy_ || cloud.serial() != serial_) {
    const CurrentDevice current(device_);
    copy_ = on_device(cloud);
    serial_ = cloud.serial();
  }
  frame_ = nullptr;
  part_ = {};
  cloud_ = copy_.get();
}

const CloudSlot* MeasureOnDevice::bring(const DepthFrame& frame) {
  const auto* const slot = dynamic_cast<const CloudSlot*>(&frame.slot());
  if (slot == nullptr || slot->options().device.first() != device_ || !slot->is_on_device())
    return nullptr;
  frame_ = slot;
  cloud_ = &slot->device_cloud();
  return slot;
}

}  // namespace vpm::cuda
