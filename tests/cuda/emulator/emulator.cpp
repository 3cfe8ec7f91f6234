#include "tests/cuda/emulator/emulator.h"

#include <sys/mman.h>
#include <ucontext.h>

#include <atomic>
#include <chrono>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/common_interface_defs.h>
#endif

thread_local constinit dim3 threadIdx, blockIdx, blockDim, gridDim;

namespace emulator {
namespace {

constexpr std::uint64_t kNotWritten = 0xA5A5'A5A5'A5A5'A5A5;

[[noreturn]] void fail(const char* message) {
  std::fprintf(stderr, "CUDA emulator: %s (block %u, thread %u)\n", message, blockIdx.x,
               threadIdx.x);
  std::abort();
}

// The stack of a fiber, in pages that are taken when they are first touched.
class Stack {
 public:
  static constexpr std::size_t kBytes = std::size_t{1} << 19;

  Stack()
      : memory_(mmap(nullptr, kBytes, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0)) {
    if (memory_ == MAP_FAILED) fail("no memory for a stack");
  }
  ~Stack() { munmap(memory_, kBytes); }
  Stack(const Stack&) = delete;
  Stack& operator=(const Stack&) = delete;
  void* memory() const { return memory_; }

 private:
  void* memory_;
};

// Names what a thread waits for.
enum class Wait : std::uint8_t { none, exchange, vote, block };

// Runs a thread of one block, then one of the next: it begins once, and waits between them.
struct Fiber {
  Stack stack;
  ucontext_t context{};  // where it begins; under AddressSanitizer, also where it goes on
  std::jmp_buf place{};  // where it goes on, without a call of the system
  bool has_begun = false;
  Wait wait = Wait::none;
  bool is_done = false;
  unsigned mask = 0, source = 0;
  bool predicate = false;
  std::uint64_t value = 0;  // given, then received
#if defined(__SANITIZE_ADDRESS__)
  void* fake_stack = nullptr;
#endif
};

// Runs blocks one after another, with a fiber for each of their threads, on one thread of the host
// at a time, which need not be the same for all blocks.
class BlockRunner {
 public:
  void run(const Launch& launch, unsigned block, const std::function<void()>& kernel);

  std::uint64_t exchange(unsigned mask, std::uint64_t value, unsigned source) {
    Fiber& self = *fibers_[current_];
    self.value = value;
    self.source = source;
    return wait_in_warp(Wait::exchange, mask), self.value;
  }
  unsigned vote(unsigned mask, bool predicate) {
    Fiber& self = *fibers_[current_];
    self.predicate = predicate;
    return wait_in_warp(Wait::vote, mask), static_cast<unsigned>(self.value);
  }
  unsigned meet_block(bool predicate) {
    Fiber& self = *fibers_[current_];
    self.predicate = predicate;
    self.wait = Wait::block;
    ++at_barrier_;
    if (!release_block()) suspend();
    return static_cast<unsigned>(self.value);
  }
  void yield() { suspend(); }
  void* shared_memory() { return shared_memory_.data(); }

 private:
  static void enter();
  void begin(Fiber* fiber) const;
  void wait_in_warp(Wait wait, unsigned mask) {
    const unsigned lane = current_ % kLanes;
    if ((mask >> lane & 1U) == 0) fail("a lane is not in its own mask");
    Fiber& self = *fibers_[current_];
    self.wait = wait;
    self.mask = mask;
    Warp& warp = warps_[current_ / kLanes];
    warp.waiting |= 1U << lane;
    if (((warp.waiting | warp.ended) & mask) != mask || !release_warp(current_ / kLanes, mask))
      suspend();
  }
  bool release_warp(unsigned warp, unsigned mask);
  bool release_block();
  void end_thread();
  void resume(unsigned thread);
  void suspend();

  std::vector<std::unique_ptr<Fiber>> fibers_;
  ucontext_t scheduler_{};
  std::jmp_buf scheduler_place_{};
  struct Warp {
    unsigned waiting = 0, ended = 0;  // a bit for each lane
  };
  std::vector<Warp> warps_;
  const std::function<void()>* kernel_ = nullptr;
  std::vector<std::uint64_t> shared_memory_;
  unsigned threads_ = 0, current_ = 0, done_ = 0, at_barrier_ = 0;
#if defined(__SANITIZE_ADDRESS__)
  void* scheduler_fake_stack_ = nullptr;
  const void* scheduler_stack_ = nullptr;
  std::size_t scheduler_bytes_ = 0;
#endif
};

thread_local BlockRunner* runner = nullptr;

BlockRunner& current() {
  if (runner == nullptr) fail("a device function was called outside of a kernel");
  return *runner;
}

// True if all lanes of the mask that have not ended wait for the same meeting; they may go on then.
bool BlockRunner::release_warp(unsigned warp, unsigned mask) {
  const unsigned first = warp * kLanes;
  Wait wait = Wait::none;
  std::uint64_t given[kLanes] = {};
  unsigned votes = 0;
  for (unsigned lane = 0; lane < kLanes; ++lane) {
    if ((mask >> lane & 1U) == 0 || first + lane >= threads_) continue;
    const Fiber& fiber = *fibers_[first + lane];
    if (fiber.is_done) continue;
    if (fiber.wait != Wait::exchange && fiber.wait != Wait::vote) return false;
    if (fiber.mask != mask) return false;
    if (wait != Wait::none && wait != fiber.wait) fail("lanes of a warp meet in different ways");
    wait = fiber.wait;
    given[lane] = fiber.value;
    votes |= fiber.predicate && wait == Wait::vote ? 1U << lane : 0U;
  }
  for (unsigned lane = 0; lane < kLanes; ++lane) {
    if ((mask >> lane & 1U) == 0 || first + lane >= threads_) continue;
    Fiber& fiber = *fibers_[first + lane];
    if (fiber.is_done) continue;
    fiber.wait = Wait::none;
    warps_[warp].waiting &= ~(1U << lane);
    fiber.value = wait == Wait::vote ? votes : given[fiber.source % kLanes];
  }
  return true;
}

bool BlockRunner::release_block() {
  if (at_barrier_ < threads_ - done_) return false;
  unsigned holds = 0;
  for (unsigned t = 0; t < threads_; ++t)
    if (!fibers_[t]->is_done && fibers_[t]->predicate) ++holds;
  for (unsigned t = 0; t < threads_; ++t) {
    Fiber& fiber = *fibers_[t];
    if (fiber.is_done) continue;
    fiber.wait = Wait::none;
    fiber.value = holds;
  }
  at_barrier_ = 0;
  return true;
}

void BlockRunner::enter() {
  BlockRunner& self = *runner;
#if defined(__SANITIZE_ADDRESS__)
  __sanitizer_finish_switch_fiber(nullptr, &self.scheduler_stack_, &self.scheduler_bytes_);
#endif
  for (;;) {
    (*self.kernel_)();
    self.end_thread();
    self.suspend();  // until a later block has a thread for it
  }
}

void BlockRunner::end_thread() {
  Fiber& self = *fibers_[current_];
  self.is_done = true;
  ++done_;
  const unsigned warp = current_ / kLanes;
  warps_[warp].ended |= 1U << current_ % kLanes;
  for (unsigned lane = 0; lane < kLanes && warp * kLanes + lane < threads_; ++lane) {
    const Fiber& other = *fibers_[warp * kLanes + lane];
    if (!other.is_done && (other.wait == Wait::exchange || other.wait == Wait::vote))
      release_warp(warp, other.mask);
  }
  if (done_ < threads_ && at_barrier_ > 0) release_block();
}

void BlockRunner::begin(Fiber* fiber) const {
  getcontext(&fiber->context);
  fiber->context.uc_stack.ss_sp = fiber->stack.memory();
  fiber->context.uc_stack.ss_size = Stack::kBytes;
  fiber->context.uc_link = nullptr;
  makecontext(&fiber->context, &BlockRunner::enter, 0);
}

void BlockRunner::resume(unsigned thread) {
  current_ = thread;
  threadIdx = dim3(thread);
  Fiber& fiber = *fibers_[thread];
#if defined(__SANITIZE_ADDRESS__)
  __sanitizer_start_switch_fiber(&scheduler_fake_stack_, fiber.stack.memory(), Stack::kBytes);
#endif
#if defined(__SANITIZE_ADDRESS__)
  swapcontext(&scheduler_, &fiber.context);
  __sanitizer_finish_switch_fiber(scheduler_fake_stack_, nullptr, nullptr);
#else
  if (_setjmp(scheduler_place_) != 0) return;
  if (fiber.has_begun) _longjmp(fiber.place, 1);
  fiber.has_begun = true;
  setcontext(&fiber.context);
#endif
}

void BlockRunner::suspend() {
  Fiber& fiber = *fibers_[current_];
#if defined(__SANITIZE_ADDRESS__)
  __sanitizer_start_switch_fiber(&fiber.fake_stack, scheduler_stack_, scheduler_bytes_);
  swapcontext(&fiber.context, &scheduler_);
  __sanitizer_finish_switch_fiber(fiber.fake_stack, &scheduler_stack_, &scheduler_bytes_);
#else
  if (_setjmp(fiber.place) == 0) _longjmp(scheduler_place_, 1);
#endif
}

void BlockRunner::run(const Launch& launch, unsigned block, const std::function<void()>& kernel) {
  runner = this;
  kernel_ = &kernel;
  threads_ = launch.threads;
  done_ = at_barrier_ = 0;
  blockIdx = dim3(block);
  blockDim = dim3(launch.threads);
  gridDim = dim3(launch.blocks);
  // New for each block, and of its size: sanitizers see accesses beyond it, and reads before any
  // write show.
  shared_memory_ = std::vector<std::uint64_t>((launch.shared_bytes + 7) / 8, kNotWritten);
  warps_.assign((threads_ + kLanes - 1) / kLanes, Warp{});
  while (fibers_.size() < threads_) {
    fibers_.push_back(std::make_unique<Fiber>());
    begin(fibers_.back().get());
  }
  for (unsigned t = 0; t < threads_; ++t) {
    fibers_[t]->is_done = false;
    fibers_[t]->wait = Wait::none;
  }
  while (done_ < threads_) {
    bool has_moved = false;
    for (unsigned t = 0; t < threads_; ++t) {
      const Fiber& fiber = *fibers_[t];
      if (fiber.is_done || fiber.wait != Wait::none) continue;
      has_moved = true;
      resume(t);
    }
    if (!has_moved) fail("threads wait for others that never come");
    if (launch.is_cooperative) std::this_thread::yield();
  }
  runner = nullptr;
}

// Keeps the runners that are idle, with their stacks: to take and give back the pages of a block's
// threads costs as much as many kernels.
class IdleRunners {
 public:
  std::unique_ptr<BlockRunner> take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return std::make_unique<BlockRunner>();
    std::unique_ptr<BlockRunner> last = std::move(idle_.back());
    idle_.pop_back();
    return last;
  }
  void give_back(std::unique_ptr<BlockRunner> blocks) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(blocks));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<BlockRunner>> idle_;
};

// Runs every `step`-th block of a launch from `first` on.
void run_blocks(const Launch& launch, unsigned first, unsigned step,
                const std::function<void()>& kernel) {
  static IdleRunners& idle = *new IdleRunners;  // for streams that outlive main()
  std::unique_ptr<BlockRunner> blocks = idle.take();
  for (unsigned b = first; b < launch.blocks; b += step) blocks->run(launch, b, kernel);
  idle.give_back(std::move(blocks));
}

}  // namespace

void run(const Launch& launch, const std::function<void()>& kernel) {
  if (!launch.is_cooperative) return run_blocks(launch, 0, 1, kernel);
  std::vector<std::thread> threads;
  for (unsigned block = 0; block < launch.blocks; ++block)
    threads.emplace_back([&, block] { run_blocks(launch, block, launch.blocks, kernel); });
  for (std::thread& thread : threads) thread.join();
}

std::uint64_t exchange(unsigned mask, std::uint64_t value, unsigned source) {
  return current().exchange(mask, value, source);
}
unsigned vote(unsigned mask, bool predicate) {
  return current().vote(mask, predicate);
}
unsigned meet_block(bool predicate) {
  return current().meet_block(predicate);
}
void yield() {
  current().yield();
}
std::uint64_t nanoseconds() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::nanoseconds(now).count());
}
void* dynamic_shared_memory() {
  return current().shared_memory();
}

}  // namespace emulator
