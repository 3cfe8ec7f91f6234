// What an image has of the square window around a pixel, along an axis and in all. Windows are
// summed in opposite pairs, from the middle outwards, first down each column, then across the
// columns. Of what the image's border cuts off, nothing is added.
#pragma once

#include "libvpm/cloud/normal_limits.h"
#include "libvpm/core/division.h"
#include "libvpm/core/host_device.h"

namespace vpm {

// Along an axis: pixels before and after the window's centre.
struct Span {
  int before, after;

  VPM_HD int count() const { return before + after + 1; }
  VPM_HD bool is_whole(int radius) const { return before == radius && after == radius; }
  VPM_HD bool has(int offset) const { return offset > 0 ? offset <= after : -offset <= before; }
  // Of the middle, from the centre.
  VPM_HD float middle() const { return 0.5F * static_cast<float>(after - before); }
  // A sum of x times the offset, which is from the centre, with the offset from the middle instead.
  // `sum`: that of x.
  template <class Real>
  [[gnu::always_inline]] VPM_HD Real about_middle(const Real& moment, const Real& sum) const {
    return moment - middle() * sum;
  }
  // A sum of x times the offset, where all x are greater by so much.
  template <class Real>
  [[gnu::always_inline]] VPM_HD Real with_greater(const Real& moment, const Real& by) const {
    return moment + static_cast<float>(count()) * middle() * by;
  }
};
VPM_HD inline Span span_of(int at, int size, int radius) {
  const int beyond = size - 1 - at;
  return {at < radius ? at : radius, beyond < radius ? beyond : radius};
}
// Whether an image's border cuts windows about `count` pixels in a row.
VPM_HD inline bool cuts_windows(int first, int count, int size, int radius) {
  return first < radius || first + count + radius > size;
}
// One that is known to be whole.
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

// Whether what is left of a window, should all of it belong to one surface, tells a plane's slopes:
// enough pixels, and two of each axis, whose spread is enough with three of the other.
VPM_HD inline bool tells_plane(Span across, Span down) {
  return across.count() >= 2 && down.count() >= 2 && across.count() * down.count() >= kMinSupport;
}

// sum + factor x. A product with 2 or 4 is exact: devices may fuse it, and give the same bits.
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

// What turns sums over all pixels of a window into slopes, means and moments.
struct WindowShape {
  float count = 0;
  float per_us = 0, per_vs = 0, per_count = 0;  // 1 over the sums of 1, and of squared offsets from
                                                // the middle
  float u = 0, v = 0;                           // the middle, from the centre
  float du = 0, dv = 0, dudu = 0, dudv = 0;     // sums of offsets from the centre

  WindowShape() = default;
  VPM_HD WindowShape(Span across, Span down) : u(across.middle()), v(down.middle()) {
    const float columns = static_cast<float>(across.count()),
                rows = static_cast<float>(down.count());
    count = columns * rows;
    // The sum of squared offsets from the middle over n in a row: n (n^2 - 1) / 12.
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
