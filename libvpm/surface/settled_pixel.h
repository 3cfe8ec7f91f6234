// What a pixel of a camera's surface is settled to: the arithmetic of settled_image.h. IEEE
// operations and square roots only, in a written order, so that host and devices have the same
// bits. Real: float, or a vector of such (core/lanes.h).
#pragma once

#include <type_traits>

#include "libvpm/surface/depth_surface.h"

namespace vpm {

// A pixel's window, to either side, and where its neighbours are asked: eight pixels, in rows and
// columns this far apart.
inline constexpr int kSettledRadius = 3, kSettledAcross = DepthSurface::kAcross;

// What is seen at a pixel: inverse depth, and the normal in camera axes.
template <class Real>
struct SeenPixel {
  Real inverse, x, y, z;
};

// Whether a neighbour shows the pixel's own smooth surface. Nothing is like a pixel without normal.
template <class Real>
[[gnu::always_inline]] VPM_HD inline auto is_alike(const SeenPixel<Real>& own,
                                                   const SeenPixel<Real>& other) {
  constexpr auto kSmooth = static_cast<float>(DepthSurface::kSmoothCosine);
  const Real off = other.inverse - own.inverse,
             allowed = static_cast<float>(DepthSurface::kJump) * own.inverse;
  return (own.x * other.x + own.y * other.y + own.z * other.z > kSmooth) & (off <= allowed) &
         (off >= -allowed);
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
    constexpr float kWidth = 2 * kSettledRadius + 1, kSide = kWidth * kWidth;
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
  for (int d = 1; d <= kSettledRadius; ++d) column.add_rows(depth(d), depth(-d), d);
  return column;
}
template <class Real, class Column>
[[gnu::always_inline]] VPM_HD inline WindowOfDepths<Real> window_of_depths(const Column& column) {
  WindowOfDepths<Real> window = column(0);
  for (int d = 1; d <= kSettledRadius; ++d) window.add_columns(column(d), column(-d), d);
  return window;
}

// A pixel and those of its neighbours that are like it.
template <class Real>
class SettledPixel {
 public:
  using Mask = decltype(Real() < Real());

  [[gnu::always_inline]] VPM_HD explicit SettledPixel(const SeenPixel<Real>& own)
      : own_(own), x_(own.x), y_(own.y), z_(own.z), all_alike_(own.inverse > 0.0F) {}

  [[gnu::always_inline]] VPM_HD void add(const SeenPixel<Real>& other) {
    const Mask alike = is_alike(own_, other);
    x_ += alike ? other.x : Real{};
    y_ += alike ? other.y : Real{};
    z_ += alike ? other.z : Real{};
    all_alike_ = all_alike_ & alike;
  }

  // After all eight. Beside a crease a paraboloid would round it off.
  [[gnu::always_inline]] VPM_HD Real inverse_depth(const WindowOfDepths<Real>& window) const {
    return static_cast<Mask>(all_alike_ & window.is_one_surface()) ? window.paraboloid()
                                                                   : own_.inverse;
  }
  // The sum of the normals, not of unit length; zero where the pixel has none.
  [[gnu::always_inline]] VPM_HD Real x() const { return x_; }
  [[gnu::always_inline]] VPM_HD Real y() const { return y_; }
  [[gnu::always_inline]] VPM_HD Real z() const { return z_; }

 private:
  SeenPixel<Real> own_;
  Real x_, y_, z_;
  Mask all_alike_;
};

// Of the pixel seen(0, 0) and those around it, seen(du, dv).
template <class Real, class Seen>
[[gnu::always_inline]] VPM_HD inline SettledPixel<Real> settled_pixel(const Seen& seen) {
  constexpr int kAcross = kSettledAcross;
  SettledPixel<Real> pixel(seen(0, 0));
  for (const int dv : {-kAcross, 0, kAcross}) {
    pixel.add(seen(-kAcross, dv));
    if (dv != 0) pixel.add(seen(0, dv));
    pixel.add(seen(kAcross, dv));
  }
  return pixel;
}

// That makes a sum of normals one of unit length; any number where the sum is zero. (A choice
// between two square roots would keep compilers from vectors.)
[[gnu::always_inline]] VPM_HD inline float per_length(float x, float y, float z) {
  const float squared = x * x + y * y + z * z;
  return 1.0F / std::sqrt(squared + (squared > 0 ? 0.0F : 1.0F));
}

}  // namespace vpm
