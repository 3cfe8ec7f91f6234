#include <algorithm>

#include "libvpm/query/cuda/measure_on_device.h"

namespace vpm::cuda {

Result MeasureOnDevice::run(const PreparedCloud& cloud, const Pose& pose) {
  const CurrentDevice current(device_);
  bring(cloud);
  return ask(pose);
}

void MeasureOnDevice::run(const PreparedCloud& cloud, std::span<const Pose> poses,
                          std::span<Result> results) {
  const CurrentDevice current(device_);
  bring(cloud);
  ask(poses, results);
}

Result MeasureOnDevice::run_frame(const DepthFrame& frame, const Pose& pose) {
  const CurrentDevice current(device_);
  if (const CloudSlot* const slot = bring(frame)) {
    const Result result = ask(pose);
    if (slot->is_sound(part_)) return result;
  }
  return run(frame.cloud(), pose);
}

void MeasureOnDevice::run_frame(const DepthFrame& frame, std::span<const Pose> poses,
                                std::span<Result> results) {
  const CurrentDevice current(device_);
  if (const CloudSlot* const slot = bring(frame)) {
    ask(poses, results);
    if (slot->is_sound(part_)) return;
  }
  run(frame.cloud(), poses, results);
}

Result MeasureOnDevice::ask(const Pose& pose) {
  const PoseFrame frame = frame_of(pose, cloud_->frame(), tool_.center_of_mass, reach());
  if (frame_ != nullptr) part_ = frame_->require(pixels_read(frame), stream());
  RawResult raw = answer(frame);
  if (raw.beyond != 0) {
    part_ = frame_->require(all_pixels(), stream());
    raw = answer(frame);
  }
  flood_microseconds_ = 1e-3 * raw.flood_ns;
  return result_of(raw, tool_, pose.rotation);
}

RawResult MeasureOnDevice::answer(const PoseFrame& frame) {
  const unsigned sequence = sequence_ + 1;
  if (standby_ && part_.is_there) {  // otherwise the stream comes to it
    if (const void* const launch = standing_launch(answer_.device())) {
      end_launched();
      const RawResult raw = standby_->ask({launch, frame.to_surface, sequence, standby_us_},
                                          *answer_.host(), sequence);
      sequence_ = sequence;
      return raw;
    }
  }
  const OtherWork other;
  has_launched_ = true;
  launch(frame, answer_.device(), sequence);
  sequence_ = sequence;
  return wait_for(*answer_.host(), sequence, stream_.get(), [] {});
}

void MeasureOnDevice::end_launched() {
  if (!has_launched_) return;
  check(cudaStreamSynchronize(stream_.get()));
  has_launched_ = false;
}

void MeasureOnDevice::ask(std::span<const Pose> poses, std::span<Result> results) {
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
