#include "libvpm/backend/device_measure.h"

#include <algorithm>
#include <future>
#include <mutex>

namespace vpm {
namespace {

// Deals out the jobs of a batch.
class Rest {
 public:
  Rest(std::size_t count, std::size_t takers) : count_(count), takers_(takers) {}

  struct Part {
    std::size_t begin = 0, count = 0;
  };
  // Takes half of an even part of the rest, so that all end together, but enough to keep a device
  // busy.
  Part take() {
    constexpr std::size_t kLeast = 512;
    const std::lock_guard lock(mutex_);
    const std::size_t left = count_ - begin_;
    const Part part{begin_, std::min(left, std::max(kLeast, left / (2 * takers_)))};
    begin_ += part.count;
    return part;
  }

 private:
  std::mutex mutex_;
  std::size_t begin_ = 0, count_, takers_;
};

}  // namespace

void SpreadMeasure::run(const SceneView& scene, std::span<DeviceMeasure* const> measures,
                        std::span<const Job> jobs, std::span<Result> results) {
  const auto on_device = [&](std::size_t device) {
    std::vector<DeviceMeasure*> there;
    for (DeviceMeasure* measure : measures)
      there.push_back(dynamic_cast<SpreadMeasure&>(*measure).measures_[device].get());
    return there;
  };
  if (jobs.size() == 1) {
    DeviceMeasure* const first =
        dynamic_cast<SpreadMeasure&>(*measures[jobs.front().tool]).measures_.front().get();
    const Job job{jobs.front().pose, 0};
    first->run(scene, {&first, 1}, {&job, 1}, results);
    return;
  }
  const SceneView cloud = scene.cloud();
  Rest rest(jobs.size(), measures_.size());
  std::vector<std::future<void>> runs;
  for (std::size_t device = 0; device < measures_.size(); ++device) {
    runs.push_back(std::async(std::launch::async, [&, device] {
      const std::vector<DeviceMeasure*> there = on_device(device);
      for (auto part = rest.take(); part.count > 0; part = rest.take())
        there.front()->run(cloud, there, jobs.subspan(part.begin, part.count),
                           results.subspan(part.begin, part.count));
    }));
  }
  for (auto& each : runs) each.get();  // rethrows
}

}  // namespace vpm
