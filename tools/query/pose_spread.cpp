#include "tools/query/pose_spread.h"

#include <utility>

#include "libvpm/core/parallel.h"

namespace vpm::tools {

PoseSpread::PoseSpread(std::size_t threads, Answer answer, Take take)
    : answer_(std::move(answer)), take_(std::move(take)) {
  try {
    for (std::size_t k = 0; k < threads; ++k) threads_.emplace_back([this, k] { work(k); });
  } catch (...) {
    stop();
    throw;
  }
}

PoseSpread::~PoseSpread() {
  stop();
}

void PoseSpread::add(AskedPose asked) {
  std::unique_lock lock(mutex_);
  const std::size_t most = kWaiting * threads_.size();
  if (slots_.size() >= most)  // until half of them are taken, so that it is woken seldom
    is_taken_.wait(lock, [&] { return slots_.size() <= most / 2 || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  slots_.push_back({std::move(asked), {}, nullptr});
  is_asked_.notify_one();
}

void PoseSpread::finish() {
  std::unique_lock lock(mutex_);
  is_taken_.wait(lock, [&] { return slots_.empty() || failure_; });
  if (failure_) std::rethrow_exception(failure_);
}

void PoseSpread::stop() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  is_asked_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

void PoseSpread::work(std::size_t thread) {
  const OneThread alone;
  std::unique_lock lock(mutex_);
  for (;;) {
    is_asked_.wait(lock, [&] { return ends_ || next_ < first_ + slots_.size(); });
    if (ends_) return;
    const std::size_t index = next_++;
    Slot& slot = slots_[index - first_];  // stays there, since only the front is taken away
    lock.unlock();
    try {
      slot.answered = answer_(thread, index, slot.asked);
    } catch (...) {
      slot.failure = std::current_exception();
    }
    lock.lock();
    slot.is_done = true;
    if (!is_taking_) take_those_ready(lock);
  }
}

// Hands over the answers at the front, while others are found.
void PoseSpread::take_those_ready(std::unique_lock<std::mutex>& lock) {
  is_taking_ = true;
  while (!failure_ && !slots_.empty() && slots_.front().is_done) {
    Slot& slot = slots_.front();
    std::exception_ptr failure = slot.failure;
    if (!failure) {
      lock.unlock();
      try {
        take_(std::move(slot.answered));
      } catch (...) {
        failure = std::current_exception();
      }
      lock.lock();
    }
    if (failure) {
      failure_ = failure;
      ends_ = true;
      is_asked_.notify_all();
    } else {
      slots_.pop_front();
      ++first_;
    }
    if (failure_ || slots_.size() <= kWaiting * threads_.size() / 2) is_taken_.notify_one();
  }
  is_taking_ = false;
}

}  // namespace vpm::tools
