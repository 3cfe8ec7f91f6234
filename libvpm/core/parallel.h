// Parallel loops on the CPU. Bodies write only to elements of their own index, so results do not
// depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>

#include "libvpm/include/vpm/device.h"

namespace vpm {

// Returns the cap that set_thread_count (vpm/device.h) has set, or the number of cores.
int thread_count();

// Calls body(begin, end) for disjoint ranges that cover [0, count), each at most `grain` long.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace vpm
