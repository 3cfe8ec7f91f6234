// Parallel loops on the CPU. Bodies write only to elements of their own index, so results do not
// depend on the number of threads.
#pragma once

#include <vpm/device.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>

namespace vpm {

// Calls body(begin, end) for disjoint ranges that cover [0, count), each at most `grain` long.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

// Keeps the work of this thread to it while the object lives: its loops have one thread. For
// threads that each have work of their own.
class OneThread {
 public:
  OneThread();
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  bool was_alone_;
};

// Runs several short parallel loops in a row on the same threads. Between loops the threads spin
// instead of sleeping, since waking them takes longer than such a loop. Each thread starts on the
// same part of the range in every region of equal size, so that what it wrote last time is still in
// its cache; a thread that is done steals from the ends of other parts.
//
// Lives on the stack of the thread that runs the loops. A region opened inside another's loop has
// one thread.
class ParallelRegion {
 public:
  ParallelRegion();
  ~ParallelRegion();
  ParallelRegion(const ParallelRegion&) = delete;
  ParallelRegion& operator=(const ParallelRegion&) = delete;

  // Returns the number of threads that may share the work, including the caller.
  int threads() const { return threads_; }

  // Calls body(begin, end) for disjoint ranges that cover [0, count), each at most `grain` long.
  // Needs count < 2^32. Late threads take what is left; the loop never waits for a thread that has
  // not started. Rethrows the first exception of a body.
  template <class Body>
  void loop(std::size_t count, std::size_t grain, const Body& body) {
    loop(count, grain, {&body, [](const void* it, std::size_t begin, std::size_t end) {
                          (*static_cast<const Body*>(it))(begin, end);
                        }});
  }

 private:
  struct Helpers;
  struct HelperTask;
  // Non-owning reference to a loop body; unlike std::function it never allocates.
  struct BodyView {
    const void* body = nullptr;
    void (*call)(const void* body, std::size_t begin, std::size_t end) = nullptr;
  };

  // Holds the ranges of one part that no thread has taken yet. A thread may read the loop's data
  // (body_, count_, grain_) only between taking a range and counting it as done: after the last
  // range the next loop overwrites them. Aligned to a cache line, so that threads do not wait for
  // each other.
  class alignas(64) Part {
   public:
    void open(std::uint64_t begin, std::uint64_t end);
    // Takes the first or the last open range. Returns false if none is left.
    bool take(bool is_first, std::uint64_t& range);

   private:
    static constexpr int kEndShift = 32;
    // Index of the first open range; above kEndShift, the index past the last.
    std::atomic<std::uint64_t> open_{0};
  };
  static constexpr std::size_t kMaxParts = 16;  // more threads than this share parts

  void loop(std::size_t count, std::size_t grain, BodyView body);
  void help();
  void end();
  void run_ranges(std::size_t own);
  void run(std::uint64_t range);

  Part parts_[kMaxParts];
  std::size_t part_count_ = 1;
  int first_thread_ = 0;  // arena index of the thread that runs the loops
  std::atomic<std::uint64_t> done_{0};
  std::atomic<bool> is_over_{false};
  std::size_t count_ = 0, grain_ = 1;
  BodyView body_;
  std::atomic<bool> has_failed_{false};
  std::exception_ptr failure_;
  int threads_;
  std::unique_ptr<Helpers> helpers_;
};

}  // namespace vpm
