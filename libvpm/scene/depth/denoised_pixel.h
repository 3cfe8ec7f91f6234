// What a pixel of a camera's surface is settled to: the arithmetic of denoised_image.h. IEEE
// operations and square roots only, in a written order, so that host and devices have the same
// bits. Real: float, or a vector of such (core/lanes.h).
#pragma once

#include <type_traits>

#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

// A pixel's window, to either side; and where its neighbours are asked: in two rings of eight
// pixels, in rows and columns this far apart.
inline constexpr int kDenoisedRadius = 3, kDenoisedAcross = DepthSurface::kAcross;
inline constexpr int kDenoisedReach = 2 * kDenoisedAcross;

// What is seen at a pixel: inverse depth, and the normal in camera axes. In marked images inverse
// depths are negative where the pixel is not clear (is_clear).
template <class Real>
struct SeenPixel {
  Real inverse, x, y, z;

  [[gnu::always_inline]] VPM_HD SeenPixel measured() const {
    return {inverse < Real{} ? -inverse : inverse, x, y, z};
  }
};

// Whether a neighbour shows the pixel's own smooth surface. Nothing is like a pixel without normal,
// nor is one that is marked like any.
template <class Real>
[[gnu::always_inline]] VPM_HD inline auto is_alike(const SeenPixel<Real>& own,
                                                   const SeenPixel<Real>& other) {
  constexpr auto kSmooth = static_cast<float>(DepthSurface::kSmoothCosine);
  const Real off = other.inverse - own.inverse,
             allowed = static_cast<float>(DepthSurface::kJump) * own.inverse;
  return (own.x * other.x + own.y * other.y + own.z * other.z > kSmooth) & (off <= allowed) &
         (off >= -allowed);
}

// Whether a pixel's window of normals holds one smooth surface, as far as the pixels at the ends of
// its row and column tell. Of the pixel seen(0, 0), not marked, and those around it, seen(du, dv).
template <class Real, class Seen>
[[gnu::always_inline]] VPM_HD inline decltype(Real() < Real()) is_clear(const Seen& seen) {
  constexpr int kEnd = kDenoisedRadius;
  const SeenPixel<Real> own = seen(0, 0);
  return is_alike(own, seen(-kEnd, 0)) & is_alike(own, seen(kEnd, 0)) &
         is_alike(own, seen(0, -kEnd)) & is_alike(own, seen(0, kEnd));
}

// An inverse depth as marked images have it; 0 stays 0.
template <class Real, class Mask>
[[gnu::always_inline]] VPM_HD inline Real marked(const Real& inverse, const Mask& clear) {
  return clear ? inverse : 0.0F - inverse;
}

// Least and greatest of some inverse depths.
template <class Real>
struct ExtentOfDepths {
  Real low, high;

  [[gnu::always_inline]] VPM_HD void take(const ExtentOfDepths& other) {
    low = other.low < low ? other.low : low;
    high = other.high > high ? other.high : high;
  }
  [[gnu::always_inline]] VPM_HD Real nearest_to(const Real& value) const {
    const Real not_below = value < low ? low : value;
    return not_below > high ? high : not_below;
  }
};

// Of a column of a window, then of the window: sums of inverse depths, and of those times the
// squared distance from the middle; their extent, and that of the pixels beside the middle.
template <class Real>
struct WindowOfDepths {
  Real sum, squares;
  ExtentOfDepths<Real> all, beside;

  WindowOfDepths() = default;
  [[gnu::always_inline]] VPM_HD explicit WindowOfDepths(const Real& middle)
      : sum(middle), squares{}, all{middle, middle}, beside{middle, middle} {}

  // The pixels at this distance below and above the middle of a column, nearer ones first.
  [[gnu::always_inline]] VPM_HD void add_rows(const Real& below, const Real& above, int distance) {
    const auto squared = static_cast<float>(distance * distance);
    const Real both = below + above;
    sum += both;
    squares += squared * both;
    all.take({below, below});
    all.take({above, above});
    if (distance == 1) beside = all;
  }
  // The columns at this distance from the middle one.
  [[gnu::always_inline]] VPM_HD void add_columns(const WindowOfDepths& right,
                                                 const WindowOfDepths& left, int distance) {
    const auto squared = static_cast<float>(distance * distance);
    const Real both = right.sum + left.sum;
    sum += both;
    squares += right.squares + left.squares + squared * both;
    all.take(right.all);
    all.take(left.all);
    if (distance == 1) {
      beside.take(right.beside);
      beside.take(left.beside);
    }
  }

  // Whether all its pixels are known and belong to one surface.
  [[gnu::always_inline]] VPM_HD auto is_one_surface() const {
    return (all.low > 0.0F) &
           (all.high - all.low <= static_cast<float>(DepthSurface::kJump) * all.high);
  }
  // At its middle, of the least-squares paraboloid of inverse depth: exact for planes, and where
  // curvature is even. It has .27 of the noise of a pixel. It never leaves the extent of the nine
  // pixels in the middle, so that what these show to be free stays so.
  [[gnu::always_inline]] VPM_HD Real paraboloid() const {
    constexpr float kWidth = 2 * kDenoisedRadius + 1, kSide = kWidth * kWidth;
    constexpr float kCount = kSide;                      // sums over the window of 1,
    constexpr float kSquare = kSide * (kSide - 1) / 12;  // of u^2, and of u^2 (u^2 + v^2)
    constexpr float kFourth = kSquare * ((3 * kSide - 7) / 20 + (kSide - 1) / 12);
    constexpr float kRatio = kFourth / kSquare;
    return beside.nearest_to((kRatio * sum - squares) / (kRatio * kCount - 2 * kSquare));
  }
};

// Of the column whose pixels are depth(dv), from its middle; of the window whose columns are
// column(du).
template <class Real, class Depth>
[[gnu::always_inline]] VPM_HD inline WindowOfDepths<Real> column_of_depths(const Depth& depth) {
  WindowOfDepths<Real> column(depth(0));
  for (int d = 1; d <= kDenoisedRadius; ++d) column.add_rows(depth(d), depth(-d), d);
  return column;
}
template <class Real, class Column>
[[gnu::always_inline]] VPM_HD inline WindowOfDepths<Real> window_of_depths(const Column& column) {
  WindowOfDepths<Real> window = column(0);
  for (int d = 1; d <= kDenoisedRadius; ++d) window.add_columns(column(d), column(-d), d);
  return window;
}

// A sum of normals, not of unit length.
template <class Real>
struct NormalSum {
  using Mask = decltype(Real() < Real());
  Real x{}, y{}, z{};

  [[gnu::always_inline]] VPM_HD void add(const Mask& which, const SeenPixel<Real>& pixel) {
    x += which ? pixel.x : Real{};
    y += which ? pixel.y : Real{};
    z += which ? pixel.z : Real{};
  }
  [[gnu::always_inline]] VPM_HD Mask is_empty() const {
    return (x == 0.0F) & (y == 0.0F) & (z == 0.0F);
  }
};

// Visits the pixels, in an order that is always the same, whose normals make that of one.
template <class Visit>
[[gnu::always_inline]] VPM_HD inline void visit_ring(int across, const Visit& visit) {
  visit(-across, -across), visit(0, -across), visit(across, -across);
  visit(-across, 0), visit(across, 0);
  visit(-across, across), visit(0, across), visit(across, across);
}
template <class Visit>
[[gnu::always_inline]] VPM_HD inline void visit_denoised(const Visit& visit) {
  visit(0, 0);
#ifdef __CUDA_ARCH__
#pragma unroll 1  // a block goes through this code once or twice: what counts is how much it is
#endif
  for (int across = kDenoisedAcross; across <= kDenoisedReach; across += kDenoisedAcross)
    visit_ring(across, visit);
}

[[gnu::always_inline]] VPM_HD inline bool is_any(bool one) {
  return one;
}
template <class Mask>
[[gnu::always_inline]] inline bool is_any(const Mask& lanes) {
  int one = 0;
  for (unsigned k = 0; k < sizeof(Mask) / sizeof(lanes[0]); ++k) one |= lanes[k];
  return one != 0;
}

// Of a pixel of a marked image, seen(0, 0), and those around it, seen(du, dv): the sum of the
// normals that show its surface. Of those at clear pixels; where there are none, of all.
template <class Real, class Seen>
[[gnu::always_inline]] VPM_HD inline NormalSum<Real> denoised_normal(const Seen& seen) {
  using Mask = typename NormalSum<Real>::Mask;
  const SeenPixel<Real> own = seen(0, 0).measured();
  NormalSum<Real> sum;
  visit_denoised([&](int du, int dv) __attribute__((always_inline)) {
    const SeenPixel<Real> pixel = seen(du, dv);
    sum.add(is_alike(own, pixel), pixel);
  });
  const Mask has_none = is_alike(own, own) & sum.is_empty();
  if (is_any(has_none)) {
    visit_denoised([&](int du, int dv) __attribute__((always_inline)) {
      const SeenPixel<Real> pixel = seen(du, dv).measured();
      sum.add(has_none & is_alike(own, pixel), pixel);
    });
  }
  return sum;
}

// Of a pixel of a marked image, and its window. Beside a crease a paraboloid would round it off.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Real denoised_inverse_depth(
    const SeenPixel<Real>& pixel, const WindowOfDepths<Real>& window) {
  using Mask = typename NormalSum<Real>::Mask;
  return static_cast<Mask>((pixel.inverse > 0.0F) & window.is_one_surface())
             ? window.paraboloid()
             : pixel.measured().inverse;
}

// That makes a sum of normals one of unit length; any number where the sum is zero. (A choice
// between two square roots would keep compilers from vectors.)
[[gnu::always_inline]] VPM_HD inline float per_length(float x, float y, float z) {
  const float squared = x * x + y * y + z * z;
  return 1.0F / std::sqrt(squared + (squared > 0 ? 0.0F : 1.0F));
}

}  // namespace vpm
