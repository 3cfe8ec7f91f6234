// Quotients and square roots with the bits of IEEE 754 on host and device.
//
// A device has no instruction for either: the compiler makes a dozen, and a branch for operands
// near the ends of the range of numbers, which every thread then jumps over, and across which it
// moves nothing. Lengths are far from there (lengths.h): here are the dozen alone, Newton's steps
// with exact remainders (Markstein 1990: "Computation of elementary functions on the IBM RISC
// System/6000 processor").
#pragma once

#include <cmath>

#include "libvpm/core/host_device.h"

namespace vpm {

// a / b, where |b| and |a / b| lie between 2^-900 and 2^900, or a is 0.
[[gnu::always_inline]] VPM_HD inline double quotient(double a, double b) {
#ifdef __CUDA_ARCH__
  double inverse;
  asm("rcp.approx.ftz.f64 %0, %1;" : "=d"(inverse) : "d"(b));
  // Its lower half is 0. Begun from there, the steps end below 1 / (1 - 2^-53); not from here.
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

// Of x between 2^-900 and 2^900, or 0, or what is not finite.
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

// 1 / b, where |b| lies between 2^-100 and 2^100.
[[gnu::always_inline]] VPM_HD inline float reciprocal(float b) {
#ifdef __CUDA_ARCH__
  float inverse;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(b));
  return __fmaf_rn(inverse, __fmaf_rn(-b, inverse, 1), inverse);
#else
  return 1 / b;
#endif
}

// a / b, where |b| and |a / b| lie there too, or a is 0.
[[gnu::always_inline]] VPM_HD inline float quotient(float a, float b) {
#ifdef __CUDA_ARCH__
  const float inverse = reciprocal(b), rounded = __fmul_rn(a, inverse);
  return __fmaf_rn(inverse, __fmaf_rn(-b, rounded, a), rounded);
#else
  return a / b;
#endif
}

// Of x between 2^-100 and 2^100, or 0, or what is not finite.
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
