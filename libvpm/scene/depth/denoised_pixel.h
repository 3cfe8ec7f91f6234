// Computes a pixel's denoised normal and inverse depth (denoised_image.h). IEEE operations and
// square roots only, in a fixed order, so that host and devices give the same bits. Real is float,
// or a vector of floats (core/lanes.h).
#pragma once

#include <cmath>

#include "libvpm/cloud/depth_image.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

// Number of passes. Each closes the pixels next to those that are known by then, so holes of twice
// that width close.
inline constexpr int kFillPasses = 2;

// True if an inverse depth is that of an unmeasured pixel that may be closed: 0, but not the -0 of
// one that was removed.
VPM_HD inline bool is_hole(float inverse) {
  return (inverse == 0) & !is_removed(inverse);
}

// Returns the mean inverse depth of opposite neighbours that see one surface, which is exact on a
// plane; 0 where there are none. `image(u, v)` is the inverse depth, 0 where unknown.
template <class Image>
VPM_HD float between_neighbors(const Image& image, int width, int height, int u, int v) {
  double sum = 0;
  int pairs = 0;
  const auto add_pair = [&](int du, int dv) {
    const int above = dv < 0 ? v + dv : v - dv, below = dv < 0 ? v - dv : v + dv;
    if (u - du < 0 || u + du >= width || above < 0 || below >= height) return;
    const double a = image(u - du, v - dv), b = image(u + du, v + dv);
    if (!(a > 0 && b > 0) || std::fabs(a - b) > DepthSurface::kJump * (a < b ? b : a)) return;
    sum += a + b;
    ++pairs;
  };
  add_pair(1, 0);
  add_pair(0, 1);
  add_pair(1, 1);
  add_pair(1, -1);
  return pairs > 0 ? static_cast<float>(sum / (2 * pairs)) : 0.0F;
}

// Half the width of a pixel's window, and the spacing of its two rings, in pixels.
inline constexpr int kDenoisedRadius = 3, kDenoisedAcross = DepthSurface::kAcross;
inline constexpr int kDenoisedReach = 2 * kDenoisedAcross;

// Holds inverse depth, 1/m, and normal in camera axes of a pixel. Marked images have negative
// inverse depths where a pixel is not clear (is_clear).
template <class Real>
struct SeenPixel {
  Real inverse, x, y, z;

  [[gnu::always_inline]] VPM_HD SeenPixel measured() const {
    return {inverse < Real{} ? -inverse : inverse, x, y, z};
  }
};

// True if a neighbour shows the pixel's own smooth surface. Never true for a pixel without normal,
// nor for one that is marked not clear.
template <class Real>
[[gnu::always_inline]] VPM_HD inline auto is_alike(const SeenPixel<Real>& own,
                                                   const SeenPixel<Real>& other) {
  constexpr auto kSmooth = static_cast<float>(DepthSurface::kSmoothCosine);
  const Real off = other.inverse - own.inverse,
             allowed = static_cast<float>(DepthSurface::kJump) * own.inverse;
  return (own.x * other.x + own.y * other.y + own.z * other.z > kSmooth) & (off <= allowed) &
         (off >= -allowed);
}

// True if a pixel's window of normals holds one smooth surface, by the pixels at the ends of its
// row and column. seen(du, dv) is the pixel at this offset, not marked.
template <class Real, class Seen>
[[gnu::always_inline]] VPM_HD inline decltype(Real() < Real()) is_clear(const Seen& seen) {
  constexpr int kEnd = kDenoisedRadius;
  const SeenPixel<Real> own = seen(0, 0);
  return is_alike(own, seen(-kEnd, 0)) & is_alike(own, seen(kEnd, 0)) &
         is_alike(own, seen(0, -kEnd)) & is_alike(own, seen(0, kEnd));
}

// Returns the inverse depth as marked images hold it; 0 stays 0.
template <class Real, class Mask>
[[gnu::always_inline]] VPM_HD inline Real marked(const Real& inverse, const Mask& clear) {
  return clear ? inverse : 0.0F - inverse;
}

// Holds the least and the greatest of a set of inverse depths.
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

// Holds the moments of a column of a window, or of the window: sums of inverse depths, and of those
// times the squared distance from the middle; ranges of all pixels, and of those next to the
// middle.
template <class Real>
struct WindowOfDepths {
  Real sum, squares;
  ExtentOfDepths<Real> all, beside;

  WindowOfDepths() = default;
  [[gnu::always_inline]] VPM_HD explicit WindowOfDepths(const Real& middle)
      : sum(middle), squares{}, all{middle, middle}, beside{middle, middle} {}

  // Adds the pixels at this distance below and above the middle of a column, nearest first.
  [[gnu::always_inline]] VPM_HD void add_rows(const Real& below, const Real& above, int distance) {
    const auto squared = static_cast<float>(distance * distance);
    const Real both = below + above;
    sum += both;
    squares += squared * both;
    all.take({below, below});
    all.take({above, above});
    if (distance == 1) beside = all;
  }
  // Adds the columns at this distance from the middle one, nearest first.
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

  // True if all pixels are known and belong to one surface.
  [[gnu::always_inline]] VPM_HD auto is_one_surface() const {
    return (all.low > 0.0F) &
           (all.high - all.low <= static_cast<float>(DepthSurface::kJump) * all.high);
  }
  // Returns the least-squares paraboloid of inverse depth at the middle: exact for planes and even
  // curvature, with .27 of a pixel's noise. Clamped to the range of the nine middle pixels, so that
  // what these show to be free stays so.
  [[gnu::always_inline]] VPM_HD Real paraboloid() const {
    constexpr float kWidth = 2 * kDenoisedRadius + 1, kSide = kWidth * kWidth;
    // Sums of 1, u^2 and u^2 (u^2 + v^2) over the window.
    constexpr float kCount = kSide;
    constexpr float kSquare = kSide * (kSide - 1) / 12;
    constexpr float kFourth = kSquare * ((3 * kSide - 7) / 20 + (kSide - 1) / 12);
    constexpr float kRatio = kFourth / kSquare;
    return beside.nearest_to((kRatio * sum - squares) / (kRatio * kCount - 2 * kSquare));
  }
};

// Return the moments of a column with pixels depth(dv), and of a window with columns column(du),
// counted from the middle.
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

// Sum of normals, not of unit length.
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

// Visits the pixels whose normals make that of one, in a fixed order.
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
#pragma unroll 1
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

// Returns the sum of the normals that show the surface of a pixel of a marked image, seen(0, 0),
// among seen(du, dv): those of clear pixels or, where there are none, of all.
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

// Returns a pixel's denoised inverse depth. Pixels that are not clear stay as measured, since a
// paraboloid would round off a crease.
template <class Real>
[[gnu::always_inline]] VPM_HD inline Real denoised_inverse_depth(
    const SeenPixel<Real>& pixel, const WindowOfDepths<Real>& window) {
  using Mask = typename NormalSum<Real>::Mask;
  return static_cast<Mask>((pixel.inverse > 0.0F) & window.is_one_surface())
             ? window.paraboloid()
             : pixel.measured().inverse;
}

// Returns the factor that makes a sum of normals a unit vector; any number for a zero sum. Written
// with one square root, so that compilers use vectors.
[[gnu::always_inline]] VPM_HD inline float per_length(float x, float y, float z) {
  const float squared = x * x + y * y + z * z;
  return 1.0F / std::sqrt(squared + (squared > 0 ? 0.0F : 1.0F));
}

}  // namespace vpm
