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

void SpreadMeasure::run(const PreparedCloud& cloud, std::span<const Pose> poses,
                        std::span<Result> results) {
  Rest rest(poses.size(), measures_.size());
  std::vector<std::future<void>> runs;
  for (const auto& measure : measures_) {
    runs.push_back(std::async(std::launch::async, [&] {
      for (auto part = rest.take(); part.count > 0; part = rest.take())
        measure->run(cloud, poses.subspan(part.begin, part.count),
                     results.subspan(part.begin, part.count));
    }));
  }
  for (auto& run : runs) run.get();  // throws what the run threw
}

}  // namespace vpm
