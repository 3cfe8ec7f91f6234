// A surface as an organised cloud holds it: one inverse depth per pixel of a pinhole camera.
//
// Inverse depth is affine in the pixel on a plane, so bilinear interpolation is exact there. Which
// side a place lies on is read off its own pixel, without normals; the normal only scales the
// distance. Camera coordinates.
#pragma once

#include <bit>

#include "libvpm/cloud/camera.h"
#include "libvpm/core/division.h"
#include "libvpm/core/lengths.h"
#include "libvpm/surface/ball_fraction.h"
#include "libvpm/surface/body.h"
#include "libvpm/surface/pixel_rectangle.h"

namespace vpm {

// Least and greatest inverse depth of a tile of pixels; low = 0 where any pixel is unknown, both 0
// where all are.
struct alignas(8) InverseDepthRange {  // read at once
  float low = 0, high = 0;
};
VPM_HD inline InverseDepthRange united(InverseDepthRange a, InverseDepthRange b) {
#ifdef __CUDA_ARCH__
  return {fminf(a.low, b.low), fmaxf(a.high, b.high)};
#else
  return {b.low < a.low ? b.low : a.low, b.high > a.high ? b.high : a.high};
#endif
}

// A view: plain pointers, for host or device.
struct DepthSurface {
  static constexpr int kMaxLevels = 16;
  // The widest and highest image: of the coarsest tiles, a look takes three by three.
  static constexpr std::uint32_t kMostPixelsASide = 1U << kMaxLevels;
  // Pixels whose inverse depths differ by more than this fraction belong to two surfaces. A plane
  // at 1 m seen by f = 525 stays below it up to a tilt of 86 degrees; a depth step of 3 % does not.
  static constexpr double kJump = 0.03;
  // Below this cosine between normal and ray the normal is not trusted to scale a distance.
  static constexpr double kGrazing = 0.05;
  // A ray that has passed the surface is inside, as far as anybody knows: what is behind it, no
  // further than the tool's reach, counts, and no flood needs to come.
  static constexpr bool kTellsInside = true;
  static constexpr bool kSearchesFoot = true;  // for the nearest surface point:
  static constexpr int kFootSteps = 5;         // steps of the search
  static constexpr double kFootPixels = 0.5;   // a step shorter than this ends the search
  static constexpr double kCreasePixels = 2;   // a foot further aside than this lies on a crease
  // Normals that differ by less than this cosine (25 degrees) belong to one smooth surface, noisy
  // or curved; those of a crease differ by more.
  static constexpr double kSmoothCosine = 0.9;

  // Windows of normals that lie this many pixels to either side see one side of a crease each: they
  // are up to twice as wide (7 pixels by default).
  static constexpr std::int32_t kAcross = 4;
  static constexpr double kSameCosine = 0.99;  // 8 degrees: normals of one side

  // Readings around the middle of a ball are taken at this part of its radius: where a paraboloid
  // is as high as in the mean over a box in the ball.
  static constexpr double kRim = 0.5;

  // Over so few pixels only a jump is told from noise.
  static constexpr std::int32_t kFewPixels = 4;
  // A ball of more pixels is not asked pixel by pixel: its parts are, soon.
  static constexpr std::int64_t kMostPixels = 1024;

  Intrinsics k;
  std::int32_t width = 0, height = 0;
  std::int32_t levels = 0;
  const Vec3f* normals = nullptr;  // of each pixel, camera axes; zero where none is known
  const InverseDepthRange* tiles[kMaxLevels] =
      {};                           // tiles[l]: 2^l by 2^l pixels; tiles[0].high is the pixel's
  const float* measured = nullptr;  // inverse depth before noise was taken out (settled_image.h):
                                    // what was seen to be free stays free

  struct Pixel {
    double inverse_depth = 0;  // 0: unknown
    std::int32_t nearest = 0;  // index of the nearest pixel
    Vec3f normal;              // of that
  };

  VPM_HD std::int32_t tiles_per_row(int level) const { return ((width - 1) >> level) + 1; }
  VPM_HD double inverse_depth(std::int32_t u, std::int32_t v) const {
    return tiles[0][v * width + u].high;
  }
  VPM_HD double measured_at(std::int32_t u, std::int32_t v) const {
    return measured[v * width + u];
  }

  // Whether four pixels are all known and show one surface. Real: double, or a vector of such.
  template <class Real>
  [[gnu::always_inline]] static VPM_HD auto is_one_surface(const Real& a, const Real& b,
                                                           const Real& c, const Real& d) {
    const Real low_ab = a < b ? a : b, low_cd = c < d ? c : d,
               low = low_ab < low_cd ? low_ab : low_cd;
    const Real high_ab = a > b ? a : b, high_cd = c > d ? c : d,
               high = high_ab > high_cd ? high_ab : high_cd;
    return (low > 0) & (high - low <= kJump * high);
  }
  // Of four pixels, at these fractions of the way from a to b, and from a to c.
  template <class Real>
  [[gnu::always_inline]] static VPM_HD Real bilinear(const Real& a, const Real& b, const Real& c,
                                                     const Real& d, const Real& along_u,
                                                     const Real& along_v) {
    const Real top = a + along_u * (b - a), bottom = c + along_u * (d - c);
    return top + along_v * (bottom - top);
  }

  // Inverse depth of the surface in the direction of x (x.z > 0). `also(u, v)` may read more at the
  // nearest pixel: a device waits for all reads together.
  template <class Also>
  VPM_HD Pixel look_up(Vec3 x, const Also& also) const {
    const double per_depth = quotient(1, x.z);
    const double u = k.fx * (x.x * per_depth) + k.cx, v = k.fy * (x.y * per_depth) + k.cy;
    const double up = u + 0.5, vp = v + 0.5;
    if (!(u >= -0.5 && v >= -0.5 && up < width && vp < height)) return {};
    // Not negative: what is cut off rounds to the nearest.
    const std::int32_t un = static_cast<std::int32_t>(up), vn = static_cast<std::int32_t>(vp);
    const std::int32_t u0 = u < 0 ? 0 : static_cast<std::int32_t>(u),
                       v0 = v < 0 ? 0 : static_cast<std::int32_t>(v);
    const std::int32_t u1 = u0 + 1 < width ? u0 + 1 : u0, v1 = v0 + 1 < height ? v0 + 1 : v0;
    const double a = inverse_depth(u0, v0), b = inverse_depth(u1, v0);
    const double c = inverse_depth(u0, v1), d = inverse_depth(u1, v1);
    const std::int32_t nearest = vn * width + un;
    const Vec3f normal = normals[nearest];
    also(un, vn);
    if (!is_one_surface(a, b, c, d))
      return {vn == v0 ? (un == u0 ? a : b) : (un == u0 ? c : d), nearest, normal};
    const double fu = u < 0 ? 0 : u - u0, fv = v < 0 ? 0 : v - v0;
    return {bilinear(a, b, c, d, fu, fv), nearest, normal};
  }

  VPM_HD Reading read(Vec3 x, std::uint32_t = kNoPoint) const {
    return read_and(x, [](std::int32_t, std::int32_t) {});
  }
  template <class Also>
  VPM_HD Reading read_and(Vec3 x, const Also& also) const {
    if (!(x.z >= kSmallestLength)) return {};  // squares of less would vanish
    const Pixel pixel = look_up(x, also);
    if (!(pixel.inverse_depth > 0)) return {};
    Reading reading;
    reading.known = true;
    const double to_foot =
        quotient(1, x.z * pixel.inverse_depth);  // foot = to_foot * x: on the ray of x
    reading.foot = to_foot * x;
    reading.point = static_cast<std::uint32_t>(pixel.nearest);
    reading.normal = widen(pixel.normal);
    const double along = dot(reading.normal, x), squared_length = squared_norm(x);
    if (along < 0 && along * along >= (kGrazing * kGrazing) * squared_length) {
      reading.distance = along * (1 - to_foot);
    } else {  // no normal, or one that cannot be right: take the surface to face the ray
      const double length = square_root(squared_length);
      reading.normal = quotient(-1, length) * x;
      reading.distance = length * (to_foot - 1);
    }
    return reading;
  }

  // The surface for places in a ball: this one, which needs no search.
  VPM_HD const DepthSurface& around_ball(Vec3, double, std::uint32_t) const { return *this; }

  // Normals of the pixels kAcross to either side of one, where there are such.
  struct Neighbors {
    bool in_row = false, in_column = false;
    Vec3f left, right, above, below;
  };
  VPM_HD Neighbors neighbors_of(std::int32_t u, std::int32_t v) const;

  // Gradient of the distance to the surface at a place x behind it: towards the nearest surface
  // point. `reading` is that of x, and known.
  VPM_HD Vec3 closest_normal(Vec3 x, const Reading& reading) const;
  class FootSearch;

  // What the pixels of a ball tell: its side, and the range of inverse depth over the tiles that
  // cover them.
  struct Look {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;  // projection needs no place to begin
    bool leaves_image = true;
    PixelRectangle pixels, tiles;  // that a place in the ball may touch; those of the tiles
    InverseDepthRange range;
    float middle = 0;  // as measured, of the pixel in the middle
  };

  VPM_HD Side side_of_ball(Vec3 center, double radius) const {
    return side_of(look_at_ball(center, radius), center, radius);
  }
  // The same of a ball that was looked at. Tiles show what lies beside it too: where they do not
  // decide, its pixels tell whether it is free.
  VPM_HD Side side_of(const Look& look, Vec3 center, double radius) const {
    const double farthest = center.z + radius;
    return may_be_seen_past(look, farthest) && is_seen_past(look.pixels, farthest, 0, 1)
               ? Side::free
               : look.side;
  }
  static VPM_HD PixelRectangle pixels_of(const Look& look) { return look.pixels; }
  // Whether the pixels of a ball, as measured, may all show no surface nearer than `depth`. The
  // middle mostly says no.
  VPM_HD bool may_be_seen_past(const Look& look, double depth) const {
    const PixelRectangle& p = look.pixels;
    return look.side == Side::mixed &&
           std::int64_t{p.u1 - p.u0 + 1} * (p.v1 - p.v0 + 1) <= kMostPixels &&
           depth * look.middle < 1;
  }
  // Whether they do not; of their rows only the `first`, and every `step` after it.
  VPM_HD bool is_seen_past(const PixelRectangle& p, double depth, std::uint32_t first,
                           std::uint32_t step) const {
    for (std::int32_t v = p.v0 + static_cast<std::int32_t>(first); v <= p.v1;
         v += static_cast<std::int32_t>(step)) {
      bool past = true;  // of a row at a time: reads that do not wait for each other
      for (std::int32_t u = p.u0; u <= p.u1; ++u) past &= depth * measured_at(u, v) < 1;
      if (!past) return false;
    }
    return true;
  }

  VPM_HD Look look_at_ball(Vec3 center, double radius) const {
    Look look;
    const double nearest = center.z - radius, farthest = center.z + radius;
    if (!(farthest > 0)) return look;
    look.side = Side::mixed;
    look.pixels = whole_image(width, height);
    if (!(nearest >= kSmallestLength)) return look;
    // |x'/z' - x/z| <= r (1 + |x|/z) / (z - r) for every x' in the ball.
    const double per_depth = quotient(1, center.z), per_nearest = quotient(radius, nearest);
    const double x = center.x * per_depth, y = center.y * per_depth;
    const double u = k.fx * x + k.cx, spread_u = k.fx * (per_nearest * (1 + std::fabs(x)));
    const double v = k.fy * y + k.cy, spread_v = k.fy * (per_nearest * (1 + std::fabs(y)));
    const double u_low = u - spread_u, u_high = u + spread_u;
    const double v_low = v - spread_v, v_high = v + spread_v;
    // Nor what overflows.
    if (!(u_high >= -0.5 && v_high >= -0.5 && u_low < width - 0.5 && v_low < height - 0.5)) {
      look.side = Side::free;
      return look;
    }
    look.leaves_image =
        u_low < -0.5 || v_low < -0.5 || u_high >= width - 0.5 || v_high >= height - 0.5;
    // Every pixel that look_up may touch for a place in the ball.
    look.pixels = {u_low < 0 ? 0 : static_cast<std::int32_t>(u_low),
                   v_low < 0 ? 0 : static_cast<std::int32_t>(v_low),
                   u_high + 1 >= width ? width - 1 : static_cast<std::int32_t>(u_high + 1),
                   v_high + 1 >= height ? height - 1 : static_cast<std::int32_t>(v_high + 1)};
    cover(look);
    if (farthest * look.range.high < 1) {
      look.side = Side::free;
    } else if (!look.leaves_image && nearest * look.range.low > 1) {
      look.side = Side::behind;
    }
    return look;
  }

  // Whether a look at a ball tells of the balls in it: their pixels are among its own where it is
  // not so near that the bound of its projection is loose.
  VPM_HD bool tells_of_parts(Vec3 center, double radius) const { return center.z > 2 * radius; }
  // Whether such a look shows a ball in the one that was looked at to be free.
  VPM_HD bool is_free_part(const Look& look, Vec3 center, double radius) const {
    return (center.z + radius) * look.range.high < 1;
  }

  // Whether the surface in a ball that was looked at may touch a ball in it, as far as that tells.
  VPM_HD bool may_touch(const Look& look, Vec3 center, double radius) const {
    return !(is_free_part(look, center, radius) || (center.z - radius) * look.range.low > 1);
  }

  // The least inverse depth in a ball that was looked at.
  static VPM_HD float least_inverse_depth(const Look& look) { return look.range.low; }
  // Whether a ball in one that was looked at may be free though the plane of all pixels there says
  // no: the pixel at its centre, as measured, shows past it, and not all of the surface there is
  // nearer than its far side. `least`: of that surface, least_inverse_depth().
  VPM_HD bool may_be_free(float least, Vec3 center, double radius) const {
    if (!((center.z + radius) * least < 1)) return false;
    if (!(center.z - radius >= kSmallestLength)) return true;
    const double per_depth = quotient(1, center.z);
    const double u = k.fx * (center.x * per_depth) + k.cx + 0.5;
    const double v = k.fy * (center.y * per_depth) + k.cy + 0.5;
    if (!(u >= 0 && v >= 0 && u < width && v < height)) return true;
    return (center.z + radius) *
               measured_at(static_cast<std::int32_t>(u), static_cast<std::int32_t>(v)) <
           1;
  }

  // False where may_be_free says so of every ball in this one, which lies in one that was looked
  // at.
  VPM_HD bool may_hold_free(const Look& look, Vec3 center, double radius) const {
    constexpr double kRounding = 1 - 1e-9;
    return (center.z - radius) * look.range.low * kRounding < 1;
  }

  // True if the surface in a ball that was looked at may be one plane.
  VPM_HD bool may_be_flat(const Look& look) const {
    return !look.leaves_image && look.range.low > 0;
  }
  // True if the surface in such a ball is one plane, as far as the range of its pixels tells: the
  // plane at the ball's centre, where read() samples the surface, predicts their least and greatest
  // depth to `tolerance`, m.
  template <class Read>
  VPM_HD bool is_flat(const Look& look, const Read& read, double tolerance,
                      TangentPlane& plane) const;
  // Whether the plane predicts the range of the ball's pixels.
  VPM_HD bool shows(const Look& look, const TangentPlane& plane, double tolerance) const;

  // The mean plane of the surface across a ball that was looked at, from readings at its middle and
  // at four places around it; false where they do not belong to one smooth surface, or the range of
  // the ball's pixels does not agree with the plane.
  template <class ReadAll>
  VPM_HD bool mean_plane(const Look& look, Vec3 center, double radius, double tolerance,
                         const ReadAll& read_all, TangentPlane& plane) const;
  // Those four places; `middle` was read at the ball's centre, and is known.
  struct PlacesAround {
    static constexpr int kCount = 4;
    Vec3 below, side, other;

    VPM_HD PlacesAround(const Reading& middle, Vec3 center, double radius);
    VPM_HD Vec3 at(int place) const {
      const Vec3 aside = place < 2 ? side : other;
      return place % 2 == 0 ? below + aside : below - aside;
    }
  };
  // The mean of what is read there and in the middle, as far as it belongs to one smooth surface.
  struct PlaneMean {
    Vec3 middle_normal, direction, feet;

    VPM_HD explicit PlaneMean(const Reading& middle)
        : middle_normal(middle.normal), direction(middle.normal), feet(middle.foot) {}
    VPM_HD bool take(const Reading& reading);  // false where it does not
    // When all is taken.
    VPM_HD TangentPlane plane() const { return {normalized_or_zero(direction), 0.2 * feet}; }
  };

  // Bound of the distance from any place in a ball that was looked at to the foot of its reading.
  VPM_HD double largest_gap(const Look& look, Vec3 center, double radius) const {
    const double nearest = center.z - radius, farthest = center.z + radius;
    if (!(nearest >= kSmallestLength && look.range.high > 0)) return HUGE_VAL;
    return (farthest - quotient(1, look.range.high)) * quotient(norm(center) + radius, nearest);
  }

  static VPM_HD double fraction_inside(const Reading& reading, Vec3, double radius) {
    return ball_fraction_inside(reading.distance / radius);
  }

 private:
  static VPM_HD bool spans_few_pixels(const Look& look) {
    const PixelRectangle& p = look.pixels;
    return p.u1 - p.u0 <= kFewPixels && p.v1 - p.v0 <= kFewPixels;
  }

  // Normals between the middle of a ball and the corners of its pixels.
  struct CornerNormals {
    Vec3f at[4];
  };
  VPM_HD CornerNormals corner_normals(const Look& look) const;
  // The mean of these and of the normal at the middle, where they belong to one smooth surface:
  // noise is averaged, and curvature cancels.
  VPM_HD Vec3 mean_normal(const Look& look, const CornerNormals& corners, Vec3 middle) const;

  // Whether two walls, each seen at its plane's foot, enclose a groove above a place behind both.
  static VPM_HD bool meet_above(Vec3 x, const TangentPlane& one, const TangentPlane& other) {
    return one.distance(other.foot) > 0 && other.distance(one.foot) > 0 && one.distance(x) < 0 &&
           other.distance(x) < 0;
  }

  // The normal of what was read at x, where its pixel lies beside a crease: of that side of it on
  // whose tangent plane the foot lies.
  VPM_HD void take_one_side(Vec3 x, const Neighbors& beside, Reading& reading) const;
  // Whether a crease passes between two neighbours of a pixel, and its normal is of neither.
  static VPM_HD bool holds_crease(Vec3f one, Vec3f other, Vec3 normal);
  // How far a place lies off the tangent plane of a pixel; without end where the pixel shows
  // another surface, or nothing.
  VPM_HD double off_plane(Vec3 place, std::int32_t i, Vec3 normal) const;

  // The greatest power of two that is not above a number; 0 for 0.
  static VPM_HD int exponent_of(std::uint32_t number) {
#ifdef __CUDA_ARCH__
    return 31 - __clz(static_cast<int>(number | 1));
#else
    return std::bit_width(number | 1) - 1;
#endif
  }

  // Takes the range of the look's pixels from at most 3 by 3 tiles.
  VPM_HD void cover(Look& look) const {
    const PixelRectangle& p = look.pixels;
    const std::int32_t wide = p.u1 - p.u0, high = p.v1 - p.v0;
    const int least = exponent_of(static_cast<std::uint32_t>(wide > high ? wide : high));
    const int level = least < levels ? least : levels - 1;
    const std::int32_t row = tiles_per_row(level);
    const std::int32_t u0 = p.u0 >> level, u1 = p.u1 >> level;
    const std::int32_t v0 = p.v0 >> level, v1 = p.v1 >> level;
    const std::int32_t u_end = (u1 + 1) << level, v_end = (v1 + 1) << level;
    look.tiles = {u0 << level, v0 << level, (u_end < width ? u_end : width) - 1,
                  (v_end < height ? v_end : height) - 1};
    look.middle = measured[(p.v0 + p.v1) / 2 * width + (p.u0 + p.u1) / 2];
    InverseDepthRange all = tiles[level][v0 * row + u0];
    const auto take = [&](std::int32_t u, std::int32_t v) {
      const InverseDepthRange tile = tiles[level][v * row + u];
      all = united(all, tile);
    };
    // Always nine, some of them twice: loads that do not wait for each other, and no branch.
    for (std::int32_t i = 0; i < 9; ++i)
      take(u0 + i % 3 < u1 ? u0 + i % 3 : u1, v0 + i / 3 < v1 ? v0 + i / 3 : v1);
    look.range = all;
  }
};

}  // namespace vpm

#include "libvpm/surface/depth_nearest.h"  // define what is declared above
#include "libvpm/surface/depth_planes.h"
