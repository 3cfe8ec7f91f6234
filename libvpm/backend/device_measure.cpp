#include "libvpm/backend/device_measure.h"

#include <algorithm>
#include <future>
#include <mutex>

namespace vpm {

void SpreadMeasure::run(const AnyBody& body, std::span<DeviceMeasure* const> measures,
                        std::span<const BodyJob> jobs, std::span<BodySum> sums) {
  const auto on_device = [&](std::size_t device) {
    std::vector<DeviceMeasure*> there;
    for (DeviceMeasure* measure : measures)
      there.push_back(dynamic_cast<SpreadMeasure&>(*measure).measures_[device].get());
    return there;
  };
  if (jobs.size() == 1) {
    DeviceMeasure* const first =
        dynamic_cast<SpreadMeasure&>(*measures[jobs.front().tool]).measures_.front().get();
    const BodyJob job{jobs.front().to_body, 0};
    first->run(body, {&first, 1}, {&job, 1}, sums);
    return;
  }
  std::mutex mutex;
  std::span<const BodyJob> rest = jobs;
  // Takes half of an even part of the rest, so that all devices end together, but enough to keep
  // one busy.
  const auto take = [&] {
    constexpr std::size_t kLeast = 512;
    const std::lock_guard lock(mutex);
    const auto part =
        rest.first(std::min(rest.size(), std::max(kLeast, rest.size() / (2 * measures_.size()))));
    rest = rest.subspan(part.size());
    return part;
  };
  std::vector<std::future<void>> runs;
  for (std::size_t device = 0; device < measures_.size(); ++device) {
    runs.push_back(std::async(std::launch::async, [&, device] {
      const std::vector<DeviceMeasure*> there = on_device(device);
      for (auto part = take(); !part.empty(); part = take())
        there.front()->run(
            body, there, part,
            sums.subspan(static_cast<std::size_t>(part.data() - jobs.data()), part.size()));
    }));
  }
  for (auto& each : runs) each.get();  // rethrows
}

}  // namespace vpm
