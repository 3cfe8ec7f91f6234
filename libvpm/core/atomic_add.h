// Adds to an integer sum that many CPU threads share. Takes no lock: a thread that waits for one
// may fall asleep, and waking takes as long as a query.
#pragma once

#include <atomic>
#include <cstdint>

namespace vpm {

inline void add_atomically(std::int64_t& sum, std::int64_t term) {
  if (term != 0) std::atomic_ref<std::int64_t>(sum).fetch_add(term, std::memory_order_relaxed);
}

}  // namespace vpm
