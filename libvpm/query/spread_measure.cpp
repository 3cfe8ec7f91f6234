#include "libvpm/query/spread_measure.h"

#include <algorithm>
#include <future>
#include <mutex>

namespace vpm {
namespace {

// Deals out what is left of a batch.
class Rest {
 public:
  Rest(std::size_t count, std::size_t takers) : count_(count), takers_(takers) {}

  struct Part {
    std::size_t begin = 0, count = 0;
  };
  // Half of a taker's share of what is left, so that all end together; but no less than what keeps
  // a device busy.
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

template <class Run>
void SpreadMeasure::deal_out(std::size_t poses, const Run& run) {
  Rest rest(poses, measures_.size());
  std::vector<std::future<void>> runs;
  for (std::size_t device = 0; device < measures_.size(); ++device) {
    runs.push_back(std::async(std::launch::async, [&, device] {
      for (auto part = rest.take(); part.count > 0; part = rest.take())
        run(device, part.begin, part.count);
    }));
  }
  for (auto& each : runs) each.get();  // throws what the run threw
}

void SpreadMeasure::run(const PreparedCloud& cloud, std::span<const Pose> poses,
                        std::span<Result> results) {
  deal_out(poses.size(), [&](std::size_t device, std::size_t begin, std::size_t count) {
    measures_[device]->run(cloud, poses.subspan(begin, count), results.subspan(begin, count));
  });
}

void SpreadMeasure::run_together(std::span<DeviceMeasure* const> measures,
                                 const PreparedCloud& cloud, std::span<const ToolPose> poses,
                                 std::span<Result> results) {
  deal_out(poses.size(), [&](std::size_t device, std::size_t begin, std::size_t count) {
    std::vector<DeviceMeasure*> there;
    for (DeviceMeasure* measure : measures)
      there.push_back(dynamic_cast<SpreadMeasure&>(*measure).measures_[device].get());
    measures_[device]->run_together(there, cloud, poses.subspan(begin, count),
                                    results.subspan(begin, count));
  });
}

}  // namespace vpm
