// How many threads a suite measures with.
#pragma once

#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/include/vpm/device.h"
#include "tools/bench/suite.h"

namespace vpm::bench {

// Returns the numbers of threads that a suite compares: what --threads gives, or else 1 and 2, but
// only 1 beside a device, which computes whatever the host's threads are.
inline std::vector<int> compared_threads(const SuiteOptions& options) {
  if (options.threads > 0) return {options.threads};
  return options.device.is_cuda() ? std::vector{1} : std::vector{1, 2};
}

// Caps the threads of the library while it lives: at what --threads gives, else at `usual`.
class ThreadCap {
 public:
  ThreadCap(const SuiteOptions& options, int usual) : before_(thread_count()) {
    set_thread_count(options.threads > 0 ? options.threads : usual);
  }
  ~ThreadCap() { set_thread_count(before_); }
  ThreadCap(const ThreadCap&) = delete;
  ThreadCap& operator=(const ThreadCap&) = delete;

 private:
  int before_;
};

}  // namespace vpm::bench
