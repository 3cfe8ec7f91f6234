// Sums in 64-bit fixed point, independent of the order of their terms.
//
// A term is rounded once to a multiple of 2^-Bits and added as an integer, so any order, any number
// of threads and any device give the same sum. The sum overflows at 2^(63 - Bits); each user states
// why its sums stay below.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>

#include "libvpm/core/host_device.h"

namespace vpm {

// Holds a sum of terms, counted in units of 2^-Bits.
template <int Bits>
struct FixedSum {
  static constexpr double kOne = static_cast<double>(std::int64_t{1} << Bits);
  std::int64_t value = 0;  // the sum times 2^Bits

  friend constexpr bool operator==(const FixedSum&, const FixedSum&) = default;

  // Returns the term as a multiple of 2^-Bits, rounded half away from zero. Uses only IEEE
  // operations and a truncating conversion; copysign avoids a branch, since signs are
  // unpredictable.
  VPM_HD static std::int64_t round(double term) {
    const double scaled = term * kOne;
    return static_cast<std::int64_t>(scaled + std::copysign(0.5, scaled));
  }
  VPM_HD void add(double term) { value += round(term); }
  VPM_HD constexpr void add(const FixedSum& other) { value += other.value; }
  VPM_HD constexpr double real() const { return static_cast<double>(value) / kOne; }
};

// Adds to an integer sum that many CPU threads share. Takes no lock: a thread that waits for one
// may fall asleep, and waking takes as long as a query.
inline void add_atomically(std::int64_t& sum, std::int64_t term) {
  if (term != 0) std::atomic_ref<std::int64_t>(sum).fetch_add(term, std::memory_order_relaxed);
}

}  // namespace vpm
