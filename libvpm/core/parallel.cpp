#include "libvpm/core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <memory>
#include <thread>
#include <utility>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace vpm {
namespace {

// Returns the cap on the number of TBB's threads, which holds while the object lives; null for
// none.
std::unique_ptr<tbb::global_control>& thread_cap() {
  static std::unique_ptr<tbb::global_control> cap;
  return cap;
}

// Tells the thread sanitizer in which order TBB runs a loop, since TBB's library is not
// instrumented. What the caller did before it made the TaskOrder comes before every turn; every
// turn, with what it throws, comes before what the caller does after the TaskOrder is destroyed.
// Turns have no order among themselves, so that races between them are found.
class TaskOrder {
 public:
  class Turn {
   public:
    explicit Turn(TaskOrder& order) : order_(order) { acquire(&order.begun_); }
    ~Turn() { release(&order_.ended_); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    TaskOrder& order_;
  };

  TaskOrder() { release(&begun_); }
  ~TaskOrder() { acquire(&ended_); }
  TaskOrder(const TaskOrder&) = delete;
  TaskOrder& operator=(const TaskOrder&) = delete;

 private:
#ifdef __SANITIZE_THREAD__
  static void acquire(char* place) {
    __tsan_acquire(place);
  }
  static void release(char* place) {
    __tsan_release(place);
  }
#else
  static void acquire(char*) {}
  static void release(char*) {}
#endif

  char begun_ = 0, ended_ = 0;
};

// Runs a part of a loop as a task. The thread sanitizer does not watch how a task reads its own
// pointers, which TBB hands over; it watches all that the task calls.
struct LoopTask {
  const std::function<void(std::size_t begin, std::size_t end)>* body;
  TaskOrder* order;

  [[gnu::no_sanitize_thread]] void operator()(const tbb::blocked_range<std::size_t>& range) const {
    const TaskOrder::Turn turn(*order);
    (*body)(range.begin(), range.end());
  }
};

// True while this thread owns a ParallelRegion or helps one: regions that it opens then have one
// thread.
thread_local bool is_in_region = false;

// True while a OneThread of this thread lives.
thread_local bool is_alone = false;

}  // namespace

void set_thread_count(int threads) {
  thread_cap().reset();
  if (threads > 0) {
    thread_cap() = std::make_unique<tbb::global_control>(
        tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  }
}

int thread_count() {
  return static_cast<int>(std::min<std::size_t>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism), 1 << 16));
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  if (count <= grain || is_alone || thread_count() == 1) {
    for (std::size_t begin = 0; begin < count; begin += grain)
      body(begin, std::min(count, begin + grain));
    return;
  }
  TaskOrder order;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), LoopTask{&body, &order},
                    tbb::simple_partitioner());
}

struct ParallelRegion::Helpers {
  tbb::task_group tasks;
  TaskOrder order;
};

// Runs one helper as a task; see LoopTask.
struct ParallelRegion::HelperTask {
  ParallelRegion* region;
  Helpers* helpers;

  [[gnu::no_sanitize_thread]] void operator()() const {
    const TaskOrder::Turn turn(helpers->order);
    region->help();
  }
};

void ParallelRegion::Part::open(std::uint64_t begin, std::uint64_t end) {
  open_.store(begin | end << kEndShift, std::memory_order_release);
}

bool ParallelRegion::Part::take(bool is_first, std::uint64_t& range) {
  constexpr std::uint64_t kOneAtEnd = std::uint64_t{1} << kEndShift;
  std::uint64_t seen = open_.load(std::memory_order_acquire);
  for (;;) {
    const std::uint64_t begin = seen % kOneAtEnd, end = seen >> kEndShift;
    if (begin >= end) return false;
    range = is_first ? begin : end - 1;
    if (open_.compare_exchange_weak(seen, is_first ? seen + 1 : seen - kOneAtEnd,
                                    std::memory_order_acq_rel, std::memory_order_acquire))
      return true;
  }
}

OneThread::OneThread() : was_alone_(std::exchange(is_alone, true)) {}

OneThread::~OneThread() {
  is_alone = was_alone_;
}

ParallelRegion::ParallelRegion() : threads_(is_in_region || is_alone ? 1 : thread_count()) {
  if (threads_ == 1) return;
  part_count_ = std::min<std::size_t>(static_cast<std::size_t>(threads_), kMaxParts);
  // A thread that is new to the scheduler has no index yet (negative); it will get index 0.
  first_thread_ = std::max(tbb::this_task_arena::current_thread_index(), 0);
  helpers_ = std::make_unique<Helpers>();
  is_in_region = true;
  try {
    for (int k = 1; k < threads_; ++k) helpers_->tasks.run(HelperTask{this, helpers_.get()});
  } catch (...) {
    end();
    throw;
  }
}

ParallelRegion::~ParallelRegion() {
  if (helpers_) end();
}

void ParallelRegion::end() {
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
  for (std::size_t k = 0; k < part_count_; ++k)
    parts_[k].open(k * ranges / part_count_, (k + 1) * ranges / part_count_);
  run_ranges(0);
  while (done_.load(std::memory_order_acquire) < ranges) std::this_thread::yield();
  if (has_failed_.exchange(false)) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ParallelRegion::run_ranges(std::size_t own) {
  std::uint64_t range = 0;
  for (std::size_t k = 0; k < part_count_; ++k) {
    Part& part = parts_[(own + k) % part_count_];
    while (part.take(k == 0, range)) run(range);
  }
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
  const int after = tbb::this_task_arena::current_thread_index() - first_thread_;
  const std::size_t own = static_cast<std::size_t>(after + threads_) % part_count_;
  while (!is_over_.load(std::memory_order_acquire)) {
    run_ranges(own);
    std::this_thread::yield();
  }
  is_in_region = false;
}

}  // namespace vpm
