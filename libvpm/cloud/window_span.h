// What an image has of the square window around a pixel, and the order in which it is summed: in
// opposite pairs, from the middle outwards, first down each column, then across the columns. The
// image's border may cut a window: du and dv are then about the middle of what is left.
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
  // Of the middle, from the centre.
  VPM_HD float middle() const { return 0.5F * static_cast<float>(after - before); }
};
VPM_HD inline Span span_of(int at, int size, int radius) {
  const int beyond = size - 1 - at;
  return {at < radius ? at : radius, beyond < radius ? beyond : radius};
}

// Whether what is left of a window, should all of it belong to one surface, tells a plane's slopes:
// enough pixels, and two of each axis, whose spread is enough with three of the other.
VPM_HD inline bool tells_plane(Span across, Span down) {
  return across.count() >= 2 && down.count() >= 2 && across.count() * down.count() >= kMinSupport;
}

// Calls middle(at) for the middle one of an odd number of pixels, then pair(after, before,
// distance) for each pair, so far from the middle: places from the window's centre on.
template <class Middle, class Pair>
[[gnu::always_inline]] VPM_HD inline void for_pairs(Span span, const Middle& middle,
                                                    const Pair& pair) {
  const int half = span.count() / 2;
  int after = half - span.before, before = span.after - half;
  float distance = 0.5F;
  if (after == before) {
    middle(after);
    ++after, --before;
    distance = 1;
  }
#ifdef __CUDA_ARCH__
#pragma unroll 1  // few windows: little code
#endif
  for (; after <= span.after; ++after, --before, distance += 1) pair(after, before, distance);
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
  float rows = 0, count = 0, squares = 0;       // pixels of a column, of all, sum of du^2
  float per_us = 0, per_vs = 0, per_count = 0;  // 1 over the sums of du^2, of dv^2 and of 1
  float u = 0, v = 0;                           // the middle, from the centre

  WindowShape() = default;
  VPM_HD WindowShape(Span across, Span down)
      : rows(static_cast<float>(down.count())), u(across.middle()), v(down.middle()) {
    const float columns = static_cast<float>(across.count());
    count = columns * rows;
    // The sum of du^2 over n in a row: n (n^2 - 1) / 12.
    const float twelve_us = count * (columns * columns - 1), twelve_vs = count * (rows * rows - 1);
    squares = quotient(twelve_us, 12.0F);
    per_us = quotient(12.0F, twelve_us), per_vs = quotient(12.0F, twelve_vs);
    per_count = reciprocal(count);
  }
};

inline WindowShape whole_window(int window) {
  const Span span{window / 2, window / 2};
  return {span, span};
}

}  // namespace vpm
