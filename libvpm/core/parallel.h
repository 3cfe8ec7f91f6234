// Parallel loops on the CPU. Bodies write only to elements of their own index, so results do not
// depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace vpm {

// Caps the number of threads for all later parallel work of the process; 0 means one per core. Not
// thread-safe: call it once, at program start.
void set_thread_count(int threads);
int thread_count();

// Calls body(begin, end) for disjoint ranges that cover [0, count), each at most `grain` long.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace vpm
