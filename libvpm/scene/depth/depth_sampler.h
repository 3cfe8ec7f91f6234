// Samples the image of a camera at any place, in camera coordinates, and computes the pixels in
// which it sees a ball.
//
// Inverse depth is affine in the pixel on a plane, so bilinear interpolation is exact there. A
// place's own pixel tells its side without normals; the normal only scales the distance. The same
// code samples one place (Vec3; host and device) or four at a time (Vec3x4; host).
#pragma once

#include <cmath>

#include "libvpm/cloud/camera.h"
#include "libvpm/core/division.h"
#include "libvpm/core/lengths.h"
#include "libvpm/scene/body.h"

namespace vpm {

struct PixelRectangle {
  std::int32_t u0 = 0, v0 = 0, u1 = -1, v1 = -1;  // inclusive; empty if u0 > u1
};

VPM_HD constexpr PixelRectangle whole_image(std::int32_t width, std::int32_t height) {
  return {0, 0, width - 1, height - 1};
}
VPM_HD constexpr bool is_empty(const PixelRectangle& r) {
  return r.u0 > r.u1 || r.v0 > r.v1;
}

// Largest offset of a point from its pixel, in pixels, at which searches over pixels find it;
// float32 rounding and recovered intrinsics stay far below.
inline constexpr double kPixelTolerance = 0.5;

// Computes the pixels [first, last] along one axis of a ball that spans [low, high] sideways and
// [nearest, farthest] in depth (both > 0).
VPM_HD inline void pixel_range(double low, double high, double nearest, double farthest, double f,
                               double c, std::int32_t size, std::int32_t& first,
                               std::int32_t& last) {
  const double begin = f * (low / (low >= 0 ? farthest : nearest)) + c - kPixelTolerance;
  const double end = f * (high / (high >= 0 ? nearest : farthest)) + c + kPixelTolerance;
  const double lowest = std::floor(begin), highest = std::ceil(end);
  first = static_cast<std::int32_t>(lowest > 0 ? (lowest < size ? lowest : size) : 0.0);
  last =
      static_cast<std::int32_t>(highest > -1 ? (highest < size - 1 ? highest : size - 1.0) : -1.0);
}

// Returns a rectangle with every pixel whose point may lie in the ball. Camera coordinates.
VPM_HD inline PixelRectangle rectangle_of_ball(const Intrinsics& k, std::int32_t width,
                                               std::int32_t height, Vec3 center, double radius) {
  const double nearest = center.z - radius, farthest = center.z + radius;
  if (!(farthest > 0)) return {};
  if (!(nearest > 0)) return whole_image(width, height);
  PixelRectangle r;
  pixel_range(center.x - radius, center.x + radius, nearest, farthest, k.fx, k.cx, width, r.u0,
              r.u1);
  pixel_range(center.y - radius, center.y + radius, nearest, farthest, k.fy, k.cy, height, r.v0,
              r.v1);
  return r;
}

// Holds the least and the greatest inverse depth, 1/m, of a tile of pixels; low = 0 where a pixel
// is unknown, both 0 where all are.
struct alignas(8) InverseDepthRange {  // one load
  float low = 0, high = 0;
};
VPM_HD inline InverseDepthRange united(InverseDepthRange a, InverseDepthRange b) {
#ifdef __CUDA_ARCH__
  return {fminf(a.low, b.low), fmaxf(a.high, b.high)};
#else
  return {b.low < a.low ? b.low : a.low, b.high > a.high ? b.high : a.high};
#endif
}

// Holds plain pointers to a frame's data, for host or device.
struct DepthSampler {
  static constexpr int kMaxLevels = 16;
  // Limits width and height of an image, so that its coarsest tiles cover any ball three by three.
  static constexpr std::uint32_t kMostPixelsASide = 1U << kMaxLevels;
  // Largest relative difference of inverse depths of pixels on one surface. A plane at 1 m seen by
  // f = 525 stays below it up to a tilt of 86 degrees; a depth step of 3 % does not.
  static constexpr double kJump = 0.03;
  // Least cosine (25 degrees) between normals of one smooth surface, noisy or curved; those of a
  // crease differ by more.
  static constexpr double kSmoothCosine = 0.9;
  // Distance in pixels, to either side, at which windows of normals see one side of a crease each:
  // they are up to twice as wide (7 pixels by default).
  static constexpr std::int32_t kAcross = 4;

  Intrinsics k;
  std::int32_t width = 0, height = 0;
  std::int32_t levels = 0;
  const Vec3f* normals = nullptr;  // one per pixel, camera axes; zero where unknown
  // Holds ranges over 2^l by 2^l pixels in tiles[l]; tiles[0].high is a pixel's inverse depth.
  const InverseDepthRange* tiles[kMaxLevels] = {};
  // Holds inverse depth, 1/m, before denoising: what was seen to be free stays so. -0 where a pixel
  // was removed (cloud/depth_image.h).
  const float* measured = nullptr;

  VPM_HD std::int32_t tiles_per_row(int level) const { return ((width - 1) >> level) + 1; }
  VPM_HD double measured_at(std::int32_t u, std::int32_t v) const {
    return measured[v * width + u];
  }
  // Returns the inverse depth of pixels, 1/m; 0 where it is unknown.
  template <class Int>
  [[gnu::always_inline]] VPM_HD auto inverse_depth(const Int& u, const Int& v) const {
    const InverseDepthRange* pixels = tiles[0];
    return gather(v * width + u, [pixels](std::int32_t i) { return pixels[i].high; });
  }

  // Samples the surface on the ray of x. Calls also(u, v), which may load more at the nearest
  // pixel, so that a device waits for all loads together. Fields other than `known` are undefined
  // where it is false.
  template <class Place, class Also>
  [[gnu::always_inline]] VPM_HD SurfaceSampleOf<RealOf<Place>> sample_and(const Place& x,
                                                                          const Also& also) const {
    using Real = RealOf<Place>;
    const Pixel<Real> pixel = look_up(x, also);
    SurfaceSampleOf<Real> on_surface;
    if (!any(pixel.known)) return on_surface;
    on_surface.known = pixel.known;
    const Real to_foot = quotient(1, x.z * pixel.inverse_depth);
    on_surface.foot = to_foot * x;  // on the ray of x
    on_surface.point = static_cast<IndexOf<Real>>(pixel.nearest);
    on_surface.normal = widen(pixel.normal);
    const Real along = dot(on_surface.normal, x), squared_length = squared_norm(x);
    const MaskOf<Real> is_trusted =
        (along < 0) & (along * along >= (kGrazing * kGrazing) * squared_length);
    on_surface.distance = along * (1 - to_foot);
    // Takes the surface to face the ray where there is no normal, or none that can be right.
    if (any(pixel.known & negated(is_trusted))) {
      const Real length = square_root(squared_length);
      on_surface.normal = choose(is_trusted, on_surface.normal, quotient(-1, length) * x);
      on_surface.distance = is_trusted ? on_surface.distance : length * (to_foot - 1);
    }
    return on_surface;
  }

  // Returns what the camera sees in the direction of a place: `seen` where sample_and() knows a
  // surface.
  VPM_HD Sight sight_at(const Vec3& x) const {
    const ViewOf<double> view = view_of(x);
    return view.is_seen ? Sight::seen : view.is_in_image ? Sight::hole : Sight::out_of_view;
  }
  // Holds where the image shows a place's direction, and where it has measured a surface there.
  template <class Real>
  struct ViewOf {
    MaskOf<Real> is_in_image{}, is_seen{};
  };
  template <class Place>
  [[gnu::always_inline]] VPM_HD ViewOf<RealOf<Place>> view_of(const Place& x) const {
    using Mask = MaskOf<RealOf<Place>>;
    const auto [is_in_image, u, v] = project(x);
    const Mask is_known = inverse_depth(truncated(u + 0.5), truncated(v + 0.5)) > 0;
    return {is_in_image, static_cast<Mask>(is_in_image & is_known)};
  }

  // Holds where a place is in the image, in pixels; 0 where it is not.
  template <class Real>
  struct Projection {
    MaskOf<Real> is_seen{};
    Real u{}, v{};
  };
  template <class Place>
  [[gnu::always_inline]] VPM_HD Projection<RealOf<Place>> project(const Place& x) const {
    using Real = RealOf<Place>;
    const Real zero{}, per_depth = quotient(1, x.z);
    const Real any_u = k.fx * (x.x * per_depth) + k.cx, any_v = k.fy * (x.y * per_depth) + k.cy;
    const double u_end = width, v_end = height;
    // Squares of depths below kSmallestLength would underflow.
    const MaskOf<Real> is_seen = (x.z >= kSmallestLength) & (any_u >= -0.5) & (any_v >= -0.5) &
                                 (any_u + 0.5 < u_end) & (any_v + 0.5 < v_end);
    return {is_seen, is_seen ? any_u : zero, is_seen ? any_v : zero};
  }

 private:
  // Cosine between ray and normal below which the normal does not scale a distance.
  static constexpr double kGrazing = 0.05;

  // Describes the image in the direction of a place.
  template <class Real>
  struct Pixel {
    MaskOf<Real> known{};
    Real inverse_depth{};
    IntOf<Real> nearest{};    // index of the nearest pixel
    StoredOf<Real> normal{};  // stored there
  };
  template <class Place, class Also>
  [[gnu::always_inline]] VPM_HD Pixel<RealOf<Place>> look_up(const Place& x,
                                                             const Also& also) const {
    using Real = RealOf<Place>;
    using Int = IntOf<Real>;
    const auto [is_seen, u, v] = project(x);
    if (!any(is_seen)) return {};
    const Real zero{};
    const Real from_u = u < 0 ? zero : u, from_v = v < 0 ? zero : v;
    const Int un = truncated(u + 0.5), vn = truncated(v + 0.5);
    const Int u0 = truncated(from_u), v0 = truncated(from_v);
    const Int u1 = u0 + 1 < width ? u0 + 1 : u0, v1 = v0 + 1 < height ? v0 + 1 : v0;
    const Real a = inverse_depth(u0, v0), b = inverse_depth(u1, v0);
    const Real c = inverse_depth(u0, v1), d = inverse_depth(u1, v1);
    const Int nearest = vn * width + un;
    const StoredOf<Real> normal = gather(normals, nearest);
    also(un, vn);
    const MaskOf<Real> is_left = widen_mask(un == u0), is_upper = widen_mask(vn == v0);
    const Real per_z = is_one_surface(a, b, c, d)
                           ? bilinear(a, b, c, d, from_u - widen(u0), from_v - widen(v0))
                       : is_upper ? (is_left ? a : b)
                                  : (is_left ? c : d);
    return {static_cast<MaskOf<Real>>(is_seen & (per_z > 0)), per_z, nearest, normal};
  }

  // True if four pixels are all known and show one surface.
  template <class Real>
  [[gnu::always_inline]] static VPM_HD auto is_one_surface(const Real& a, const Real& b,
                                                           const Real& c, const Real& d) {
    const Real low_ab = a < b ? a : b, low_cd = c < d ? c : d,
               low = low_ab < low_cd ? low_ab : low_cd;
    const Real high_ab = a > b ? a : b, high_cd = c > d ? c : d,
               high = high_ab > high_cd ? high_ab : high_cd;
    return (low > 0) & (high - low <= kJump * high);
  }
  // Interpolates between four pixels, at these fractions of the way from a to b and from a to c.
  template <class Real>
  [[gnu::always_inline]] static VPM_HD Real bilinear(const Real& a, const Real& b, const Real& c,
                                                     const Real& d, const Real& along_u,
                                                     const Real& along_v) {
    const Real top = a + along_u * (b - a), bottom = c + along_u * (d - c);
    return top + along_v * (bottom - top);
  }
};

}  // namespace vpm
