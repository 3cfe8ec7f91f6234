// Several short parallel loops one after the other, by the same threads: between two loops they
// wait for the next instead of falling asleep, since waking takes longer than such a loop does.
// Every thread begins with a part of its own, the same in each region of as many threads: what it
// wrote the last time is still in its cache. Who is done takes from the ends of other parts.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>

namespace vpm {

// Lives on the stack of the thread that runs the loops. Within a loop of a region, another region
// has no threads but its own.
class ParallelRegion {
 public:
  ParallelRegion();
  ~ParallelRegion();
  ParallelRegion(const ParallelRegion&) = delete;
  ParallelRegion& operator=(const ParallelRegion&) = delete;

  // How many may share the work, this one included.
  int threads() const { return threads_; }

  // Calls body(begin, end) for disjoint ranges that cover [0, count), each at most `grain` long:
  // less than 2^32. Threads that come late find the rest; nobody waits for one that has not come.
  template <class Body>
  void loop(std::size_t count, std::size_t grain, const Body& body) {
    loop(count, grain, {&body, [](const void* it, std::size_t begin, std::size_t end) {
                          (*static_cast<const Body*>(it))(begin, end);
                        }});
  }

 private:
  struct Helpers;
  // What a loop calls; unlike a std::function it takes no memory.
  struct BodyView {
    const void* body = nullptr;
    void (*call)(const void* body, std::size_t begin, std::size_t end) = nullptr;
  };

  // The ranges of a part that nobody has taken. Who takes one may read the loop's data, which stay
  // until it is done; who takes none must not.
  class alignas(64) Part {  // a line of the cache
   public:
    void open(std::uint64_t begin, std::uint64_t end);
    // The first one, or the last one.
    bool take(bool is_first, std::uint64_t& range);

   private:
    static constexpr int kEndShift = 32;
    std::atomic<std::uint64_t> open_{0};  // the first one, and above kEndShift the one behind them
  };
  static constexpr std::size_t kMostParts = 16;  // further threads share them

  void loop(std::size_t count, std::size_t grain, BodyView body);
  void help();
  void end();
  void run_ranges(std::size_t own);
  void run(std::uint64_t range);

  Part parts_[kMostParts];
  std::size_t part_count_ = 1;
  int first_thread_ = 0;  // the arena's index of the one that runs the loops
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
