#include "libvpm/core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace vpm {
namespace {

std::unique_ptr<tbb::global_control>& thread_cap() {
  static std::unique_ptr<tbb::global_control> cap;
  return cap;
}

// Tells the thread sanitizer that what one thread does before give() is done before what another
// does after take(). TBB sees to that, but its library is not instrumented. The bodies of a loop
// stay unordered, so that their races are found.
class Handover {
 public:
#ifdef __SANITIZE_THREAD__
  void give() { __tsan_release(&place_); }
  void take() { __tsan_acquire(&place_); }

 private:
  char place_ = 0;
#else
  void give() {}
  void take() {}
#endif
};

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
  if (count <= grain || thread_count() == 1) {
    for (std::size_t begin = 0; begin < count; begin += grain)
      body(begin, std::min(count, begin + grain));
    return;
  }
  Handover begun, done;
  begun.give();
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [&](const tbb::blocked_range<std::size_t>& range) {
        begun.take();
        body(range.begin(), range.end());
        done.give();
      },
      tbb::simple_partitioner());
  done.take();
}

}  // namespace vpm
