#include <algorithm>

#include "libvpm/backend/cuda/measure_on_device.h"
#include "libvpm/core/parallel.h"

namespace vpm::cuda {

void MeasureOnDevice::run(const SceneView& scene, std::span<DeviceMeasure* const> measures,
                          std::span<const Job> jobs, std::span<Result> results) {
  if (scene.frame() != nullptr) {
    if (const CloudSlot* const slot = bring(*scene.frame())) {
      ask(measures, jobs, results);
      if (slot->is_sound()) return;
    }
  }
  bring(scene.cloud());
  ask(measures, jobs, results);
}

Result MeasureOnDevice::ask(const Pose& pose) {
  const CurrentDevice current(device_);
  if (frame_ != nullptr) frame_->require(stream());
  launch(to_surface(pose, cloud_->to_world()), answer_.device(), sequence_ + 1);
  const RawResult raw = wait_for(*answer_.host(), ++sequence_, stream_.get());
  flood_microseconds_ = 1e-3 * raw.flood_ns;
  return result_of(raw, tool_, pose.rotation);
}

Pose MeasureOnDevice::to_surface(const Pose& pose, const Pose& surface_to_world) const {
  return relative_to(surface_to_world, {pose.rotation, pose * tool_.center_of_mass});
}

std::span<const RawResult> MeasureOnDevice::answers_of(std::span<const ToolPart> tools,
                                                       std::span<const Pose> to_surfaces) {
  check(cudaMemcpyAsync(batch_->poses.get(), to_surfaces.data(), to_surfaces.size_bytes(),
                        cudaMemcpyHostToDevice, stream_.get()));
  launch(tools, batch_->poses.get(), batch_->results.get());
  check(cudaMemcpyAsync(batch_->answers.data(), batch_->results.get(),
                        to_surfaces.size() * sizeof(RawResult), cudaMemcpyDeviceToHost,
                        stream_.get()));
  check(cudaStreamSynchronize(stream_.get()));
  return {batch_->answers.data(), to_surfaces.size()};
}

void MeasureOnDevice::ask(std::span<DeviceMeasure* const> measures, std::span<const Job> jobs,
                          std::span<Result> results) {
  if (measures.size() == 1 && jobs.size() == 1) {
    results.front() = ask(jobs.front().pose);
    return;
  }
  const CurrentDevice current(device_);
  if (!batch_) batch_ = std::make_unique<Batch>();
  if (frame_ != nullptr) frame_->require(stream());
  for (std::size_t begin = 0; begin < jobs.size(); begin += Batch::kPoses) {
    const std::size_t count = std::min(Batch::kPoses, jobs.size() - begin);
    order_by_tool(measures, jobs.subspan(begin, count));
    const std::span<const RawResult> answers = answers_of(batch_->tools, batch_->ordered);
    std::size_t k = 0;
    for (const ToolPart& part : batch_->tools)
      for (; k < part.end; ++k)
        results[begin + batch_->places[k]] = result_of(
            answers[k], part.measure->tool_, jobs[begin + batch_->places[k]].pose.rotation);
  }
}

// A counting sort: tools that have poses, in their order, and of each the poses in theirs.
void MeasureOnDevice::order_by_tool(std::span<DeviceMeasure* const> measures,
                                    std::span<const Job> jobs) {
  std::vector<std::uint32_t> next(measures.size() + 1, 0);
  for (const Job& job : jobs) ++next[job.tool + 1];
  batch_->tools.clear();
  for (std::size_t t = 0; t < measures.size(); ++t) {
    const bool has_poses = next[t + 1] > 0;
    next[t + 1] += next[t];
    if (has_poses)
      batch_->tools.push_back({&dynamic_cast<MeasureOnDevice&>(*measures[t]), next[t + 1]});
  }
  batch_->ordered.resize(jobs.size());
  batch_->places.resize(jobs.size());
  for (std::uint32_t k = 0; k < jobs.size(); ++k) {
    const std::uint32_t place = next[jobs[k].tool]++;
    batch_->ordered[place] = jobs[k].pose;
    batch_->places[place] = k;
  }
  constexpr std::size_t kPosesPerTask = 2048;
  std::size_t first = 0;
  for (const ToolPart& part : batch_->tools) {
    parallel_for(part.end - first, kPosesPerTask, [&](std::size_t begin, std::size_t end) {
      for (Pose& pose : std::span(batch_->ordered).subspan(first + begin, end - begin))
        pose = part.measure->to_surface(pose, cloud_->to_world());
    });
    first = part.end;
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

namespace vpm {

std::unique_ptr<DeviceMeasure> make_device_measure(const ToolModel& tool, const Level& level,
                                                   const QueryOptions& options) {
  const Device& device = options.device;
  const int count = device.index == Device::kAll ? std::max(1, cuda_device_count()) : 1;
  std::vector<std::unique_ptr<DeviceMeasure>> measures;
  for (int k = 0; k < count; ++k)
    measures.push_back(cuda::make_refined_measure(tool, level, options, device.first() + k));
  if (measures.size() == 1) return std::move(measures.front());
  return std::make_unique<SpreadMeasure>(std::move(measures));
}

}  // namespace vpm
