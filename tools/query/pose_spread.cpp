#include "tools/query/pose_spread.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "libvpm/core/parallel.h"

namespace vpm::tools {
namespace {

// Takes the first poses away.
class ChunkCutter {
 public:
  explicit ChunkCutter(const PoseChunk& whole) : whole_(whole), left_(whole.lines.text) {}

  std::size_t left() const { return whole_.count() - cut_; }
  PoseChunk cut(std::size_t count) {
    PoseChunk chunk{whole_.first + cut_};
    const auto first = whole_.poses.begin() + static_cast<std::ptrdiff_t>(cut_);
    cut_ += count;
    if (!whole_.poses.empty()) {
      chunk.poses.assign(first, first + static_cast<std::ptrdiff_t>(count));
      return chunk;
    }
    std::size_t end = 0;
    for (std::size_t k = 0; k < count; ++k) end = left_.find('\n', end) + 1;
    chunk.lines = {std::string(left_.substr(0, end)), count, whole_.lines.parser};
    left_.remove_prefix(end);
    return chunk;
  }

 private:
  const PoseChunk& whole_;
  std::string_view left_;  // lines
  std::size_t cut_ = 0;
};

}  // namespace

PoseSpread::PoseSpread(std::size_t threads, std::function<Answer()> make_answer, Take take)
    : make_answer_(std::move(make_answer)), take_(std::move(take)) {
  try {
    for (std::size_t k = 0; k < threads; ++k) threads_.emplace_back([this] { work(); });
  } catch (...) {
    stop();
    throw;
  }
}

PoseSpread::~PoseSpread() {
  stop();
}

void PoseSpread::add(const PoseChunk& poses) {
  for (ChunkCutter cutter(poses); cutter.left() > 0;)
    add_chunk(cutter.cut(size_of_chunk(cutter.left())));
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

// Returns how many of the poses that are left the next chunk has.
std::size_t PoseSpread::size_of_chunk(std::size_t left) {
  constexpr double kSeconds = 5e-4;
  constexpr std::size_t kMost = 64;
  const std::lock_guard lock(mutex_);
  if (failure_) return left;
  const double by_time = seconds_per_pose_ > 0 ? kSeconds / seconds_per_pose_ : 1;
  const std::size_t share = (waiting_ + left) / threads_.size();
  const std::size_t most = std::min({left, share, kMost});
  return static_cast<std::size_t>(
      std::clamp(by_time, 1.0, std::max(1.0, static_cast<double>(most))));
}

void PoseSpread::add_chunk(PoseChunk chunk) {
  std::unique_lock lock(mutex_);
  const std::size_t most = kWaiting * threads_.size();
  if (waiting_ >= most)  // until half of them are taken, so that it is woken seldom
    is_taken_.wait(lock, [&] { return waiting_ <= most / 2 || failure_; });
  waiting_ += chunk.count();
  slots_.push_back({std::move(chunk), {}});
  is_asked_.notify_one();
}

void PoseSpread::finish() {
  std::unique_lock lock(mutex_);
  is_taken_.wait(lock, [&] { return slots_.empty() || failure_; });
  if (failure_) std::rethrow_exception(failure_);
}

std::vector<PoseChunk> PoseSpread::stop() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  is_asked_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
  std::vector<PoseChunk> left;
  for (Slot& slot : std::exchange(slots_, {})) left.push_back(std::move(slot.chunk));
  return left;
}

void PoseSpread::work() {
  const OneThread alone;
  Answer answer;
  std::exception_ptr failure;
  try {
    answer = make_answer_();
  } catch (...) {
    failure = std::current_exception();
  }
  std::unique_lock lock(mutex_);
  failure ? fail(failure) : answer_chunks(answer, lock);
}

void PoseSpread::answer_chunks(const Answer& answer, std::unique_lock<std::mutex>& lock) {
  using Clock = std::chrono::steady_clock;
  for (;;) {
    is_asked_.wait(lock, [&] { return ends_ || next_ < slots_.size(); });
    if (ends_) return;
    Slot& slot = slots_[next_++];  // stays there, since only the front is taken away
    lock.unlock();
    const auto start = Clock::now();
    try {
      slot.answered = answer(slot.chunk);
    } catch (...) {
      slot.answered.failure = std::current_exception();
    }
    const std::chrono::duration<double> taken = Clock::now() - start;
    lock.lock();
    note_time(taken.count() / static_cast<double>(slot.chunk.count()));
    slot.is_done = true;
    if (!is_taking_) take_those_ready(lock);
  }
}

// Learns at once that poses are dear, and slowly that they are cheap.
void PoseSpread::note_time(double seconds_per_pose) {
  constexpr double kKept = 0.9;
  seconds_per_pose_ =
      std::max(seconds_per_pose, kKept * seconds_per_pose_ + (1 - kKept) * seconds_per_pose);
}

// Hands over the answers at the front, while others are found. All that are ready go together,
// since a file is written faster by fewer calls.
void PoseSpread::take_those_ready(std::unique_lock<std::mutex>& lock) {
  is_taking_ = true;
  while (!failure_ && !slots_.empty() && slots_.front().is_done) {
    std::vector<AnsweredChunk> answered;
    std::exception_ptr failure;
    try {
      answered.reserve(slots_.size());
    } catch (...) {
      fail(std::current_exception());
      break;
    }
    for (std::size_t k = 0; k < slots_.size() && slots_[k].is_done && !failure; ++k) {
      failure = slots_[k].answered.failure;
      answered.push_back(std::move(slots_[k].answered));
    }
    const std::size_t count = answered.size();
    lock.unlock();
    try {
      take_(std::move(answered));
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    for (std::size_t k = failure ? 1 : 0; k < count; ++k) {
      waiting_ -= slots_.front().chunk.count();
      slots_.pop_front();
      --next_;
    }
    if (failure) fail(failure);
    if (waiting_ <= kWaiting * threads_.size() / 2) is_taken_.notify_one();
  }
  is_taking_ = false;
}

void PoseSpread::fail(std::exception_ptr failure) {
  if (!failure_) failure_ = std::move(failure);
  ends_ = true;
  is_asked_.notify_all();
  is_taken_.notify_one();
}

}  // namespace vpm::tools
