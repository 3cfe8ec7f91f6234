// Vectors of numbers by the extension that GCC and Clang share: each operation is that of IEEE 754
// in each lane, on whatever vectors the CPU has, so no value depends on them. For loops whose sums
// compilers do not keep in registers by themselves. Not for device code.
//
// Vectors go from function to function only where one is inlined into the other (always_inline:
// without optimisation too), since functions that are compiled for other CPUs pass them otherwise.
#pragma once

#include <cstdint>
#include <cstring>

namespace vpm {

// Lanes of a vector of floats; a vector of doubles has half as many. Wide ones are for long rows.
inline constexpr int kLanes = 8, kWideLanes = 16;

using Floats = float __attribute__((vector_size(32)));
using Doubles = double __attribute__((vector_size(32)));
using Ints = std::int32_t __attribute__((vector_size(32)));
using WideFloats = float __attribute__((vector_size(64)));
using WideInts = std::int32_t __attribute__((vector_size(64)));
using WideUnsigned = std::uint32_t __attribute__((vector_size(64)));
using HalfFloats = float __attribute__((vector_size(16)));

template <class Vector, class Number>
[[gnu::always_inline]] inline Vector load(const Number* from) {
  Vector vector;
  static_assert(sizeof(vector[0]) == sizeof(Number));
  std::memcpy(&vector, from, sizeof vector);
  return vector;
}

template <class Vector, class Number>
[[gnu::always_inline]] inline void store(const Vector& vector, Number* to) {
  static_assert(sizeof(vector[0]) == sizeof(Number));
  std::memcpy(to, &vector, sizeof vector);
}

// The half of the floats that begins at a lane, as doubles.
[[gnu::always_inline]] inline Doubles doubles(const Floats& from, int first) {
  HalfFloats half;
  std::memcpy(&half, reinterpret_cast<const float*>(&from) + first, sizeof half);
  return __builtin_convertvector(half, Doubles);
}

}  // namespace vpm
