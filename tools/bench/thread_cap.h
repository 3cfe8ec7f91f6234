// How many threads a suite measures with.
#pragma once

#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/include/vpm/device.h"
#include "tools/bench/suite.h"

namespace vpm::bench {

// Returns the numbers of threads that a suite compares: 1 and 2, or what --threads gives.
inline std::vector<int> compared_threads(const SuiteOptions& options) {
  return options.threads > 0 ? std::vector{options.threads} : std::vector{1, 2};
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
