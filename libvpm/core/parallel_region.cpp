#include "libvpm/core/parallel_region.h"

#include <tbb/task_group.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

thread_local bool is_in_region = false;

}  // namespace

struct ParallelRegion::Helpers {
  tbb::task_group tasks;
};

ParallelRegion::ParallelRegion() : threads_(is_in_region ? 1 : thread_count()) {
  if (threads_ == 1) return;
  is_in_region = true;
  helpers_ = std::make_unique<Helpers>();
  for (int k = 1; k < threads_; ++k) helpers_->tasks.run([this] { help(); });
}

ParallelRegion::~ParallelRegion() {
  if (!helpers_) return;
  is_over_.store(true, std::memory_order_release);
  helpers_->tasks.wait();
  is_in_region = false;
}

void ParallelRegion::loop(std::size_t count, std::size_t grain, BodyView body) {
  count_ = count;
  grain_ = std::max<std::size_t>(grain, 1);
  body_ = body;
  const std::uint64_t ranges = (count + grain_ - 1) / grain_;
  if (threads_ == 1 || ranges <= 1) {
    for (std::uint64_t range = 0; range < ranges; ++range)
      body.call(body.body, range * grain_, std::min(count, (range + 1) * grain_));
    return;
  }
  done_.store(0, std::memory_order_relaxed);
  open_ranges_.store(ranges, std::memory_order_release);
  std::uint64_t range = 0;
  while (take_range(range)) run(range);
  while (done_.load(std::memory_order_acquire) < ranges) std::this_thread::yield();
  if (has_failed_.exchange(false)) std::rethrow_exception(std::exchange(failure_, nullptr));
}

bool ParallelRegion::take_range(std::uint64_t& range) {
  std::uint64_t open = open_ranges_.load(std::memory_order_acquire);
  while (open > 0) {
    if (open_ranges_.compare_exchange_weak(open, open - 1, std::memory_order_acq_rel)) {
      range = open - 1;
      return true;
    }
  }
  return false;
}

void ParallelRegion::run(std::uint64_t range) {
  try {
    body_.call(body_.body, range * grain_, std::min(count_, (range + 1) * grain_));
  } catch (...) {
    if (!has_failed_.exchange(true)) failure_ = std::current_exception();
  }
  done_.fetch_add(1, std::memory_order_release);
}

void ParallelRegion::help() {
  if (is_in_region) return;
  is_in_region = true;
  std::uint64_t range = 0;
  while (!is_over_.load(std::memory_order_acquire)) {
    if (take_range(range))
      run(range);
    else
      std::this_thread::yield();
  }
  is_in_region = false;
}

}  // namespace vpm
