// Quotients and square roots with the bits of IEEE 754 on host and device.
//
// GPUs have no instruction for either. The compiler emits a dozen instructions and a branch for
// operands near the ends of the number range; that branch costs every thread a jump and stops code
// motion. Our operands are far from those ends (kSmallestLength, kLargestLength), so the device
// code below omits the branch: Newton's steps with exact remainders (Markstein 1990, "Computation
// of elementary functions on the IBM RISC System/6000 processor").
#pragma once

#include <cmath>

#include "libvpm/core/host_device.h"

namespace vpm {

// Returns a / b of vectors of numbers, on the host.
template <class Vector>
[[gnu::always_inline]] inline Vector quotient(const Vector& a, const Vector& b) {
  return a / b;
}

// Returns a / b, correctly rounded, for |b| and |a / b| in [2^-900, 2^900], or a = 0.
[[gnu::always_inline]] VPM_HD inline double quotient(double a, double b) {
#ifdef __CUDA_ARCH__
  double inverse;
  asm("rcp.approx.ftz.f64 %0, %1;" : "=d"(inverse) : "d"(b));
  // Sets the lower half, which the instruction leaves 0, to 1: from there the steps end at the
  // correctly rounded inverse also where it lies just below a power of two.
  inverse = __hiloint2double(__double2hiint(inverse), 1);
  double error = __fma_rn(-b, inverse, 1);
  error = __fma_rn(error, error, error);
  inverse = __fma_rn(inverse, error, inverse);
  error = __fma_rn(-b, inverse, 1);
  inverse = __fma_rn(inverse, error, inverse);
  const double rounded = __dmul_rn(a, inverse);
  return __fma_rn(inverse, __fma_rn(-b, rounded, a), rounded);
#else
  return a / b;
#endif
}

// Returns the square root, correctly rounded, for x in [2^-900, 2^900]; returns x itself where it
// is 0, infinite or not a number.
[[gnu::always_inline]] VPM_HD inline double square_root(double x) {
#ifdef __CUDA_ARCH__
  double inverse;
  asm("rsqrt.approx.ftz.f64 %0, %1;" : "=d"(inverse) : "d"(x));
  const double error = __fma_rn(x, -__dmul_rn(inverse, inverse), 1);
  inverse = __fma_rn(__fma_rn(error, 0.375, 0.5), __dmul_rn(inverse, error), inverse);
  const double rounded = __dmul_rn(x, inverse);
  const double root = __fma_rn(0.5 * inverse, __fma_rn(-rounded, rounded, x), rounded);
  return x > 0 && x < HUGE_VAL ? root : x;
#else
  return std::sqrt(x);
#endif
}

// Returns 1 / b, correctly rounded, for |b| in [2^-100, 2^100].
[[gnu::always_inline]] VPM_HD inline float reciprocal(float b) {
#ifdef __CUDA_ARCH__
  float inverse;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(b));
  return __fmaf_rn(inverse, __fmaf_rn(-b, inverse, 1), inverse);
#else
  return 1 / b;
#endif
}

// Returns a / b, correctly rounded, for |b| and |a / b| in [2^-100, 2^100], or a = 0.
[[gnu::always_inline]] VPM_HD inline float quotient(float a, float b) {
#ifdef __CUDA_ARCH__
  const float inverse = reciprocal(b), rounded = __fmul_rn(a, inverse);
  return __fmaf_rn(inverse, __fmaf_rn(-b, rounded, a), rounded);
#else
  return a / b;
#endif
}

// Returns the square root, correctly rounded, for x in [2^-100, 2^100]; returns x itself where it
// is 0, infinite or not a number.
[[gnu::always_inline]] VPM_HD inline float square_root(float x) {
#ifdef __CUDA_ARCH__
  float inverse;
  asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(x));
  const float rounded = __fmul_rn(x, inverse);
  const float root = __fmaf_rn(__fmaf_rn(-rounded, rounded, x), 0.5F * inverse, rounded);
  return x > 0 && x < HUGE_VALF ? root : x;
#else
  return std::sqrt(x);
#endif
}

}  // namespace vpm
