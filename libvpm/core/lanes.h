// SIMD vectors in the extension that GCC and Clang share, and functions compiled for several CPUs.
// Each lane computes by IEEE 754 whatever vectors the CPU has, so results do not depend on the CPU.
// Loops use them whose sums compilers do not keep in registers. Not for device code.
//
// Functions that take or return vectors must be inlined (always_inline, which also holds without
// optimisation): clones for other CPUs would pass vectors by another calling convention.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>  // defines __GLIBC__ where the loader can choose
#include <cstring>

// Marks functions that GCC compiles for AVX-512, for AVX2 and for baseline x86-64; the loader
// chooses at start. All clones give the same bits: they run the same IEEE operations in the same
// order, and contraction is off. `flatten` inlines callees, so that these are cloned too. Each
// clone takes as long to compile: what gains nothing from AVX-512 takes the second mark.
#if defined(__x86_64__) && __GNUC__ >= 12 && !defined(__clang__) && defined(__GLIBC__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__CUDACC__)
#define VPM_VECTOR_CLONES [[gnu::target_clones("arch=x86-64-v4", "avx2", "default"), gnu::flatten]]
#define VPM_AVX2_CLONES [[gnu::target_clones("avx2", "default"), gnu::flatten]]
#else
#define VPM_VECTOR_CLONES
#define VPM_AVX2_CLONES
#endif

namespace vpm {

// Number of lanes of Floats and of WideFloats; Doubles, of the size of Floats, has half as many
// lanes. Wide vectors serve long rows of an image.
inline constexpr int kLanes = 8, kWideLanes = 16;

using Floats = float __attribute__((vector_size(32)));
using Doubles = double __attribute__((vector_size(32)));
using Ints = std::int32_t __attribute__((vector_size(32)));
using WideFloats = float __attribute__((vector_size(64)));
using WideInts = std::int32_t __attribute__((vector_size(64)));
using WideUnsigned = std::uint32_t __attribute__((vector_size(64)));
using HalfFloats = float __attribute__((vector_size(16)));

// Starts to read objects that a search is likely to need soon, all their cache lines.
template <class Object>
[[gnu::always_inline]] inline void prefetch(const Object* first, std::size_t count = 1) {
  constexpr std::size_t kCacheLine = 64;  // bytes
  const char* const bytes = reinterpret_cast<const char*>(first);
  for (std::size_t at = 0; at < count * sizeof(Object); at += kCacheLine)
    __builtin_prefetch(bytes + at);
}

// Returns the numbers at `from`, which need not be aligned, as a vector.
template <class Vector, class Number>
[[gnu::always_inline]] inline Vector load(const Number* from) {
  Vector vector;
  static_assert(sizeof(vector[0]) == sizeof(Number));
  std::memcpy(&vector, from, sizeof vector);
  return vector;
}

// Writes the lanes of a vector to `to`, which need not be aligned.
template <class Vector, class Number>
[[gnu::always_inline]] inline void store(const Vector& vector, Number* to) {
  static_assert(sizeof(vector[0]) == sizeof(Number));
  std::memcpy(to, &vector, sizeof vector);
}

// Returns lanes first, first + 1, first + 2, first + 3 as doubles.
[[gnu::always_inline]] inline Doubles doubles(const Floats& from, int first) {
  HalfFloats half;
  std::memcpy(&half, reinterpret_cast<const float*>(&from) + first, sizeof half);
  return Doubles{half[0], half[1], half[2], half[3]};  // converted by one instruction so
}

}  // namespace vpm
