// Runs work that may crash in a process of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace vpm {

struct ChildLimits {
  std::uint64_t memory = 0;  // bytes beyond what this process has
  unsigned seconds = 0;      // processor time
};

struct ChildResult {
  enum class End { returned, crashed, out_of_time };
  End end = End::returned;
  std::string bytes;  // result of the work
};

// Calls `work` in a child process. Beyond the limit of memory, which holds on Linux, it meets
// std::bad_alloc; it has crashed if it ends in any way without returning. What `work` writes to
// standard error is lost. It must not throw, start threads or wait for any: the child has none but
// the one that called. Throws Error(refused) if no process can be made.
ChildResult run_in_child(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace vpm
