// Extent inside the image of the square window around a pixel. Windows are summed in opposite pairs
// from the middle outwards, first down each column, then across columns; pixels beyond the image
// add nothing.
#pragma once

#include "libvpm/core/division.h"
#include "libvpm/core/host_device.h"

namespace vpm {

// Limits of a window's side, px.
inline constexpr int kMinWindow = 3, kMaxWindow = 31;

// Fewest pixels of a window that determine a plane, and the least variance along their narrowest
// direction, px^2; two neighbouring diagonals have 1/8.
inline constexpr int kMinSupport = 6;
inline constexpr float kMinSpread = 0.1F;

// Number of pixels before and after the window's centre along one axis.
struct Span {
  int before, after;

  VPM_HD int count() const { return before + after + 1; }
  VPM_HD bool is_whole(int radius) const { return before == radius && after == radius; }
  VPM_HD bool has(int offset) const { return offset > 0 ? offset <= after : -offset <= before; }
  // Returns the offset of the middle of the span from the window's centre.
  VPM_HD float middle() const { return 0.5F * static_cast<float>(after - before); }
  // Converts `moment`, a sum of x times offset from the centre, to offsets from the middle. `sum`
  // is that of x.
  template <class Real>
  [[gnu::always_inline]] VPM_HD Real about_middle(const Real& moment, const Real& sum) const {
    return moment - middle() * sum;
  }
  // Returns the sum of x times offset after every x grows by `by`.
  template <class Real>
  [[gnu::always_inline]] VPM_HD Real with_greater(const Real& moment, const Real& by) const {
    return moment + static_cast<float>(count()) * middle() * by;
  }
};
VPM_HD inline Span span_of(int at, int size, int radius) {
  const int beyond = size - 1 - at;
  return {at < radius ? at : radius, beyond < radius ? beyond : radius};
}
// True if the image's border cuts a window about one of `count` pixels from `first` on.
VPM_HD inline bool cuts_windows(int first, int count, int size, int radius) {
  return first < radius || first + count + radius > size;
}
// A span known to be whole.
struct WholeSpan {
  int radius;

  VPM_HD int count() const { return 2 * radius + 1; }
  VPM_HD static constexpr bool has(int /*offset*/) { return true; }
  template <class Real>
  [[gnu::always_inline]] VPM_HD static Real about_middle(const Real& moment, const Real& /*sum*/) {
    return moment;
  }
  template <class Real>
  [[gnu::always_inline]] VPM_HD static Real with_greater(const Real& moment, const Real& /*by*/) {
    return moment;
  }
};

// True if a window without holes determines a plane's slopes: at least two pixels along each axis
// and kMinSupport in all.
VPM_HD inline bool tells_plane(Span across, Span down) {
  return across.count() >= 2 && down.count() >= 2 && across.count() * down.count() >= kMinSupport;
}

// Adds factor * x. Devices may fuse products with 2 or 4, which are exact, without changing bits.
template <class Real>
[[gnu::always_inline]] VPM_HD inline void add_times(float factor, const Real& x, Real& sum) {
#ifdef __CUDA_ARCH__
  if (factor == 2 || factor == 4) {
    sum = __fmaf_rn(factor, x, sum);
    return;
  }
#endif
  sum += factor * x;
}

// Factors that turn sums over all pixels of a window into slopes, means and moments.
struct WindowShape {
  float count = 0;
  // Inverses of the sums of 1 and of squared offsets from the middle.
  float per_us = 0, per_vs = 0, per_count = 0;
  float u = 0, v = 0;  // middle, from the centre
  // Sums of offsets from the centre and of their products.
  float du = 0, dv = 0, dudu = 0, dudv = 0;

  WindowShape() = default;
  VPM_HD WindowShape(Span across, Span down) : u(across.middle()), v(down.middle()) {
    const float columns = static_cast<float>(across.count()),
                rows = static_cast<float>(down.count());
    count = columns * rows;
    // Uses that squared offsets from the middle of n in a row sum to n (n^2 - 1) / 12.
    const float twelve_us = count * (columns * columns - 1), twelve_vs = count * (rows * rows - 1);
    per_us = quotient(12.0F, twelve_us), per_vs = quotient(12.0F, twelve_vs);
    per_count = reciprocal(count);
    du = count * u, dv = count * v;
    dudu = quotient(twelve_us, 12.0F) + du * u, dudv = du * v;
  }
};

inline WindowShape whole_window(int window) {
  const Span span{window / 2, window / 2};
  return {span, span};
}

}  // namespace vpm
