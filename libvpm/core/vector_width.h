// One text for every width: names the types that go with a Real, and gives a single number the
// operations that vectors have. Code over them selects with masks; it guards what is long by
// any(mask), which for a single number is the branch. Real is double here and Double4 in
// core/vec3x4.h; devices have double alone.
#pragma once

#include <cmath>
#include <cstdint>

#include "libvpm/core/vec3.h"

namespace vpm {

template <class Real>
struct WidthOf;
template <>
struct WidthOf<double> {
  using Mask = bool;
  using Int = std::int32_t;
  using Index = std::uint32_t;
  using Place = Vec3;    // what is computed with
  using Stored = Vec3f;  // what memory holds of it
};

template <class Real>
using MaskOf = typename WidthOf<Real>::Mask;
template <class Real>
using IntOf = typename WidthOf<Real>::Int;
template <class Real>
using IndexOf = typename WidthOf<Real>::Index;
template <class Real>
using PlaceOf = typename WidthOf<Real>::Place;
template <class Real>
using StoredOf = typename WidthOf<Real>::Stored;
// The type of the coordinates of a Vec3 or Vec3x4.
template <class Place>
using RealOf = decltype(Place::x);

[[gnu::always_inline]] VPM_HD inline bool any(bool mask) {
  return mask;
}
[[gnu::always_inline]] VPM_HD inline bool all(bool mask) {
  return mask;
}
[[gnu::always_inline]] VPM_HD inline bool negated(bool mask) {
  return !mask;
}
[[gnu::always_inline]] VPM_HD inline bool widen_mask(bool mask) {
  return mask;
}
// Returns the bits where a comparison holds, else none.
[[gnu::always_inline]] VPM_HD inline std::uint32_t bits_where(bool mask, std::uint32_t bits) {
  return mask ? bits : 0;
}
[[gnu::always_inline]] VPM_HD inline Vec3 choose(bool mask, Vec3 a, Vec3 b) {
  return mask ? a : b;
}

[[gnu::always_inline]] VPM_HD inline double absolute(double a) {
  return std::fabs(a);
}
[[gnu::always_inline]] VPM_HD inline std::int32_t truncated(double a) {
  return static_cast<std::int32_t>(a);
}
[[gnu::always_inline]] VPM_HD inline double widen(std::int32_t a) {
  return a;
}
// Returns get(i), a float, as double.
template <class Get>
[[gnu::always_inline]] VPM_HD inline double gather(std::int32_t i, const Get& get) {
  return get(i);
}
[[gnu::always_inline]] VPM_HD inline Vec3f gather(const Vec3f* row, std::int32_t i) {
  return row[i];
}
// Returns a number below 2^31.
[[gnu::always_inline]] VPM_HD inline std::int32_t gather(const std::uint32_t* row, std::int32_t i) {
  return static_cast<std::int32_t>(row[i]);
}

// Four numbers side by side for device code, with what sums use of the operations of Double4.
struct FourDoubles {
  double number[4];

  VPM_HD double operator[](int k) const { return number[k]; }
  VPM_HD friend FourDoubles operator+(const FourDoubles& a, const FourDoubles& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]};
  }
  VPM_HD friend FourDoubles operator-(const FourDoubles& a, const FourDoubles& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]};
  }
  VPM_HD friend FourDoubles operator*(const FourDoubles& a, const FourDoubles& b) {
    return {a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]};
  }
  VPM_HD friend FourDoubles operator+(const FourDoubles& a, double b) { return a + all_of(b); }
  VPM_HD friend FourDoubles operator-(const FourDoubles& a, double b) { return a - all_of(b); }
  VPM_HD friend FourDoubles operator*(double a, const FourDoubles& b) { return all_of(a) * b; }
  VPM_HD friend FourDoubles operator/(const FourDoubles& a, double b) {
    return {quotient(a[0], b), quotient(a[1], b), quotient(a[2], b), quotient(a[3], b)};
  }
  VPM_HD FourDoubles& operator+=(const FourDoubles& o) { return *this = *this + o; }
  VPM_HD FourDoubles& operator-=(const FourDoubles& o) { return *this = *this - o; }

 private:
  VPM_HD static FourDoubles all_of(double a) { return {a, a, a, a}; }
};

#ifdef __CUDACC__
using FourNumbers = FourDoubles;
#endif

}  // namespace vpm

#ifndef __CUDACC__
#include "libvpm/core/vec3x4.h"  // before the templates that call its functions
#endif
