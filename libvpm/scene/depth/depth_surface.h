// Defines the surface of an organised cloud: a camera's image, in camera coordinates.
#pragma once

#include <bit>

#include "libvpm/scene/body.h"
#include "libvpm/scene/depth/depth_nearest.h"
#include "libvpm/scene/depth/depth_sampler.h"
#include "libvpm/scene/mean_plane.h"

namespace vpm {

// Holds plain pointers to a frame's data, for host or device.
struct DepthSurface : DepthSampler {
  static constexpr bool kSearchesFoot = true;
  // A ray that has passed the surface is inside as far as anybody knows, so places behind it count
  // up to the tool radius without a flood.
  static constexpr bool kTellsInside = true;

  VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t = kNoPoint) const {
    return sample_and(x, [](std::int32_t, std::int32_t) {});
  }
  // Returns the sampler for places in a ball: this one, since projection needs no search.
  VPM_HD const DepthSurface& around_ball(Vec3, double, std::uint32_t) const { return *this; }

  // Returns the unit direction from a place x behind the surface to the nearest surface point.
  // `on_surface` is the sample at x and must be known.
  VPM_HD Vec3 closest_normal(Vec3 x, const SurfaceSample& on_surface) const {
    return search_normal(*this, x, on_surface);
  }

  // Holds the class of a ball, and the range of inverse depth over the tiles that cover its pixels.
  struct BallClass {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;  // always: projection needs no start
    bool leaves_image = true;
    // Pixels that a place in the ball may touch, none where it is out of view; pixels of the tiles.
    PixelRectangle pixels, tiles;
    InverseDepthRange range;
    float middle = 0;  // measured inverse depth of the pixel in the middle
  };

  // Returns the side of a classified ball. Its tiles hold other pixels too: where they do not
  // decide, its own pixels tell if it is free.
  VPM_HD Side side_of(const BallClass& in_ball, Vec3 center, double radius) const {
    const double farthest = center.z + radius;
    return may_be_seen_past(in_ball, farthest) && is_seen_past(in_ball.pixels, farthest, 0, 1)
               ? Side::free
               : in_ball.side;
  }
  static VPM_HD PixelRectangle pixels_of(const BallClass& in_ball) { return in_ball.pixels; }
  // True if the pixels of a ball may all have measured no surface nearer than `depth`, m. The
  // middle pixel rules most balls out.
  VPM_HD bool may_be_seen_past(const BallClass& in_ball, double depth) const {
    const PixelRectangle& p = in_ball.pixels;
    return in_ball.side == Side::ambiguous &&
           std::int64_t{p.u1 - p.u0 + 1} * (p.v1 - p.v0 + 1) <= kMostPixels &&
           depth * in_ball.middle < 1;
  }
  // True if every measured pixel of `p` in rows first, first + step, ... lies beyond `depth`, m.
  VPM_HD bool is_seen_past(const PixelRectangle& p, double depth, std::uint32_t first,
                           std::uint32_t step) const {
    for (std::int32_t v = p.v0 + static_cast<std::int32_t>(first); v <= p.v1;
         v += static_cast<std::int32_t>(step)) {
      bool past = true;  // a row at a time: independent loads
      for (std::int32_t u = p.u0; u <= p.u1; ++u) past &= depth * measured_at(u, v) < 1;
      if (!past) return false;
    }
    return true;
  }

  VPM_HD BallClass classify_ball(Vec3 center, double radius) const {
    BallClass in_ball;
    const double nearest = center.z - radius, farthest = center.z + radius;
    if (!(farthest > 0)) return in_ball;
    in_ball.side = Side::ambiguous;
    in_ball.pixels = whole_image(width, height);
    if (!(nearest >= kSmallestLength)) return in_ball;
    // |x'/z' - x/z| <= r (1 + |x|/z) / (z - r) for every x' in the ball.
    const double per_depth = quotient(1, center.z), per_nearest = quotient(radius, nearest);
    const double x = center.x * per_depth, y = center.y * per_depth;
    const double u = k.fx * x + k.cx, spread_u = k.fx * (per_nearest * (1 + std::fabs(x)));
    const double v = k.fy * y + k.cy, spread_v = k.fy * (per_nearest * (1 + std::fabs(y)));
    const double u_low = u - spread_u, u_high = u + spread_u;
    const double v_low = v - spread_v, v_high = v + spread_v;
    // True for numbers that overflowed too.
    if (!(u_high >= -0.5 && v_high >= -0.5 && u_low < width - 0.5 && v_low < height - 0.5)) {
      in_ball.side = Side::free;
      in_ball.pixels = {};
      return in_ball;
    }
    in_ball.leaves_image =
        u_low < -0.5 || v_low < -0.5 || u_high >= width - 0.5 || v_high >= height - 0.5;
    // Covers all pixels that look_up may touch for a place in the ball.
    in_ball.pixels = {u_low < 0 ? 0 : static_cast<std::int32_t>(u_low),
                      v_low < 0 ? 0 : static_cast<std::int32_t>(v_low),
                      u_high + 1 >= width ? width - 1 : static_cast<std::int32_t>(u_high + 1),
                      v_high + 1 >= height ? height - 1 : static_cast<std::int32_t>(v_high + 1)};
    cover(in_ball);
    in_ball.side = side_by_range(in_ball.range, in_ball.leaves_image, center, radius);
    return in_ball;
  }
  // Returns the side of a ball that classify_ball() left ambiguous, by tiles of a quarter or less
  // of the size, which hold fewer pixels besides the ball's own. The middle pixel rules most balls
  // out that the surface cuts.
  VPM_HD Side side_by_small_tiles(const BallClass& in_ball, Vec3 center, double radius) const {
    const double nearest = center.z - radius, middle = in_ball.middle;
    if (!(nearest >= kSmallestLength)) return in_ball.side;
    if ((center.z + radius) * middle >= 1 && (in_ball.leaves_image || nearest * middle <= 1))
      return in_ball.side;
    const PixelRectangle& p = in_ball.pixels;
    const int level = level_of_tiles(p, kCloser);
    const std::int32_t per_row = tiles_per_row(level);
    const std::int32_t last = p.u1 >> level;
    InverseDepthRange all{HUGE_VALF, 0};
    for (std::int32_t v = p.v0 >> level; v <= p.v1 >> level; ++v) {
      const InverseDepthRange* const row = tiles[level] + v * per_row;
      // Three at once, none of which waits for another to be read; the last ones are read again.
      for (std::int32_t u = p.u0 >> level; u <= last; u += 3) {
        const InverseDepthRange one = row[u], two = row[u < last ? u + 1 : last],
                                three = row[u + 1 < last ? u + 2 : last];
        all = united(united(all, one), united(two, three));
      }
    }
    return side_by_range(all, in_ball.leaves_image, center, radius);
  }

  // Returns the side of a classified ball that is ambiguous by the depths of its tiles, by those
  // of smaller tiles off the plane at its middle. Inverse depth is affine in the pixel on a plane,
  // so the surface lies between two planes that differ from this by the least and the greatest
  // difference over the ball's pixels; a ball may be clear of both where it is not of all depths
  // between.
  VPM_HD Side side_by_plane(const BallClass& in_ball, Vec3 center, double radius) const {
    constexpr double kRounding = 1e-9;
    if (in_ball.side != Side::ambiguous || !(center.z - radius >= kSmallestLength))
      return in_ball.side;
    const AffineDepth plane = plane_of_middle(in_ball.pixels);
    // On the ray of x, inverse depth times x.z is that of x and these.
    const Vec3 across{plane.per_u * k.fx, plane.per_v * k.fy,
                      plane.per_u * k.cx + plane.per_v * k.cy};
    // Returns the greatest (`end` 1) or the least (-1) product of depth and the surface's inverse
    // depth on the ray, over the ball, for this rest of inverse depth. Both grow with the rest,
    // since the ball lies before the camera.
    const auto depths = [&](double constant, double end) {
      const Vec3 g = across + Vec3{0, 0, constant};
      return dot(g, center) + end * radius * norm(g);
    };
    const bool may_be_behind = !in_ball.leaves_image && in_ball.range.low > 0;
    // The pixel in the middle is one of those that the range is over.
    if (depths(plane.rest, 1) >= 1 - kRounding &&
        !(may_be_behind && depths(plane.rest, -1) > 1 + kRounding))
      return in_ball.side;
    const AffineRange rest = rest_range(plane, in_ball);
    if (depths(rest.high, 1) < 1 - kRounding) return Side::free;
    return may_be_behind && depths(rest.low, -1) > 1 + kRounding ? Side::behind : in_ball.side;
  }

  // Returns what is seen of all places in a classified ball.
  static VPM_HD Sight sight_of(const BallClass& in_ball) {
    if (in_ball.leaves_image) return is_empty(in_ball.pixels) ? Sight::out_of_view : Sight::mixed;
    return in_ball.range.low > 0    ? Sight::seen
           : in_ball.range.high > 0 ? Sight::mixed
                                    : Sight::hole;
  }

  // True if the class of a ball tells about the balls in it: their pixels are among its own, unless
  // the ball is so near that the bound of its projection is loose. Behind the camera there are
  // none.
  VPM_HD bool tells_of_parts(Vec3 center, double radius) const {
    return center.z > 2 * radius || center.z + radius <= 0;
  }
  // True if the class of a ball shows a ball in it to be free.
  VPM_HD bool is_free_part(const BallClass& in_ball, Vec3 center, double radius) const {
    return (center.z + radius) * in_ball.range.high < 1;
  }

  // Returns the least inverse depth in a classified ball, 1/m.
  static VPM_HD float least_inverse_depth(const BallClass& in_ball) { return in_ball.range.low; }
  // True if a ball in a classified one may be free although it lies behind the mean plane of all
  // pixels: the measured pixel at its centre lies beyond it. `least`, the least_inverse_depth() of
  // the outer ball, rules most balls out.
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

  // False only if may_be_free() is false for every ball in this part of a classified ball.
  VPM_HD bool may_hold_free(const BallClass& in_ball, Vec3 center, double radius) const {
    constexpr double kRounding = 1 - 1e-9;
    return (center.z - radius) * in_ball.range.low * kRounding < 1;
  }

  // True if the surface in a classified ball may be one plane.
  VPM_HD bool may_be_flat(const BallClass& in_ball) const {
    return !in_ball.leaves_image && in_ball.range.low > 0;
  }
  // True if the surface in a ball that may_be_flat() is one plane: the plane at the ball's centre,
  // which read() samples, predicts the least and greatest depth of its pixels to `tolerance`, m.
  template <class Read>
  VPM_HD bool is_flat(const BallClass& in_ball, const Read& read, double tolerance,
                      TangentPlane& plane) const {
    const SurfaceSample on_surface = read();
    if (!on_surface.known) return false;
    const CornerNormals corners = corner_normals(in_ball);  // loaded early
    plane = {on_surface.normal, on_surface.foot};
    if (!shows(in_ball, plane, tolerance)) return false;
    plane.normal = mean_normal(in_ball, corners, on_surface.normal);
    return true;
  }
  // True if the plane predicts the range of the ball's pixels, to `tolerance`, m.
  VPM_HD bool shows(const BallClass& in_ball, const TangentPlane& plane, double tolerance) const {
    if (spans_few_pixels(in_ball))
      return in_ball.range.high - in_ball.range.low <= kJump * in_ball.range.high;
    const double per_height = quotient(1, dot(plane.normal, plane.foot));
    const double per_u = quotient(plane.normal.x * per_height, k.fx);
    const double per_v = quotient(plane.normal.y * per_height, k.fy);
    const PixelRectangle& t = in_ball.tiles;
    const double u = 0.5 * (t.u0 + t.u1) - k.cx, v = 0.5 * (t.v0 + t.v1) - k.cy;
    const double middle = per_u * u + per_v * v + plane.normal.z * per_height;
    const double spread =
        0.5 * (std::fabs(per_u) * (t.u1 - t.u0) + std::fabs(per_v) * (t.v1 - t.v0));
    const double allowed = quotient(tolerance, plane.foot.z * plane.foot.z);
    return std::fabs(middle - spread - in_ball.range.low) <= allowed &&
           std::fabs(middle + spread - in_ball.range.high) <= allowed;
  }

  // Finds the mean plane of the surface across a ball that may_be_flat(), from samples at its
  // middle and at four places around it. Returns false if they do not belong to one smooth surface,
  // or the plane does not predict the range of the ball's pixels.
  template <class SampleAll>
  VPM_HD bool mean_plane(const BallClass& in_ball, Vec3 center, double radius, double tolerance,
                         const SampleAll& sample_all, TangentPlane& plane) const {
    return mean_of_five(*this, center, radius, kSmoothCosine, sample_all, plane) &&
           shows(in_ball, plane, tolerance);
  }
  // Bounds the distance, m, from any place in a classified ball to the foot of its sample.
  VPM_HD double largest_gap(const BallClass& in_ball, Vec3 center, double radius) const {
    const double nearest = center.z - radius, farthest = center.z + radius;
    if (!(nearest >= kSmallestLength && in_ball.range.high > 0)) return HUGE_VAL;
    return (farthest - quotient(1, in_ball.range.high)) * quotient(norm(center) + radius, nearest);
  }

  template <class Shape>
  static VPM_HD double fraction_inside(const SurfaceSample& on_surface, Vec3, const Shape& shape) {
    return fraction_behind(shape, on_surface.distance, on_surface.normal);
  }

 private:
  // Over so few pixels only a jump can be told from noise.
  static constexpr std::int32_t kFewPixels = 4;
  // Balls of more pixels are not tested pixel by pixel, since their parts soon are.
  static constexpr std::int64_t kMostPixels = 1024;
  // Least length of a ray, one unit deep, along the normal of a plane that it shows.
  static constexpr double kGrazingPlane = 0.1;

  // Returns the side of a ball before the camera by the range over its pixels.
  static VPM_HD Side side_by_range(InverseDepthRange range, bool leaves_image, Vec3 center,
                                   double radius) {
    if ((center.z + radius) * range.high < 1) return Side::free;
    return !leaves_image && (center.z - radius) * range.low > 1 ? Side::behind : Side::ambiguous;
  }

  static VPM_HD bool spans_few_pixels(const BallClass& in_ball) {
    const PixelRectangle& p = in_ball.pixels;
    return p.u1 - p.u0 <= kFewPixels && p.v1 - p.v0 <= kFewPixels;
  }

  // Holds the normals halfway between the middle of a ball and the corners of its pixels.
  struct CornerNormals {
    Vec3f at[4];
  };
  VPM_HD CornerNormals corner_normals(const BallClass& in_ball) const {
    const PixelRectangle& p = in_ball.pixels;
    const std::int32_t u = (p.u1 - p.u0) / 4, v = (p.v1 - p.v0) / 4;
    const std::int32_t above = (p.v0 + v) * width, below = (p.v1 - v) * width;
    return {{normals[above + p.u0 + u], normals[above + p.u1 - u], normals[below + p.u0 + u],
             normals[below + p.u1 - u]}};
  }
  // Returns the mean of the normal in the middle and those corner normals that belong to its
  // surface, which averages noise and cancels curvature.
  VPM_HD Vec3 mean_normal(const BallClass& in_ball, const CornerNormals& corners,
                          Vec3 middle) const {
    if (spans_few_pixels(in_ball)) return middle;
    Vec3 sum = middle;
    for (const Vec3f& corner : corners.at) {
      const Vec3 normal = widen(corner);
      if (dot(normal, middle) > kSmoothCosine) sum += normal;
    }
    return normalized_or_zero(sum);
  }

  // Holds how inverse depth changes with the pixel on a plane, and what is left of it, 1/m.
  struct AffineDepth {
    double per_u = 0, per_v = 0, rest = 0;
  };
  // Bounds what is left of inverse depth without that, 1/m.
  struct AffineRange {
    double low = HUGE_VAL, high = -HUGE_VAL;
  };
  // Returns that of the plane at the pixel in the middle; no change where its normal tells little.
  VPM_HD AffineDepth plane_of_middle(const PixelRectangle& p) const {
    const std::int32_t u = (p.u0 + p.u1) / 2, v = (p.v0 + p.v1) / 2;
    const Vec3 n = widen(normals[v * width + u]);
    const double inverse = inverse_depth(u, v);
    const Vec3 ray{quotient(u - k.cx, k.fx), quotient(v - k.cy, k.fy), 1};
    const double along = -dot(n, ray);
    if (!(along > kGrazingPlane)) return {0, 0, inverse};
    const double per_height = -quotient(inverse, along);
    const double per_u = quotient(n.x * per_height, k.fx), per_v = quotient(n.y * per_height, k.fy);
    return {per_u, per_v, inverse - per_u * u - per_v * v};
  }
  // Bounds inverse depth over a ball's pixels, and between them, without its part that is affine.
  VPM_HD AffineRange rest_range(const AffineDepth& plane, const BallClass& in_ball) const {
    const PixelRectangle& p = in_ball.pixels;
    const int level = level_of_tiles(p, kCloser);
    const std::int32_t u0 = p.u0 >> level, v0 = p.v0 >> level, last = (p.u1 >> level) - u0;
    const double size = std::int32_t{1} << level, middle = 0.5 * (size - 1);
    const double first_u = u0 * size + middle;  // pixels, of the middle of a tile
    double at_v = v0 * size + middle;
    const InverseDepthRange* row = tiles[level] + (v0 * tiles_per_row(level) + u0);
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (std::int32_t rows_after = (p.v1 >> level) - v0; rows_after >= 0; --rows_after) {
      const double of_row = plane.per_v * at_v;
      double at_u = first_u;
      for (std::int32_t u = 0; u <= last; ++u) {
        const double affine = of_row + plane.per_u * at_u;
        const double off_low = row[u].low - affine, off_high = row[u].high - affine;
        low = off_low < low ? off_low : low;
        high = off_high > high ? off_high : high;
        at_u += size;
      }
      at_v += size;
      row += tiles_per_row(level);
    }
    // Within a tile, and up to half a pixel where the nearest pixel counts alone.
    const double slack = (middle + 0.5) * (std::fabs(plane.per_u) + std::fabs(plane.per_v));
    return {low - slack, high + slack};
  }

  // Returns the exponent of the greatest power of two that is not above a number; 0 for 0.
  static VPM_HD int exponent_of(std::uint32_t number) {
#ifdef __CUDA_ARCH__
    return 31 - __clz(static_cast<int>(number | 1));
#else
    return std::bit_width(number | 1) - 1;
#endif
  }

  // Levels by which the tiles of a closer look are smaller.
  static constexpr int kCloser = 2;
  // Returns the level of which at most 3 by 3 tiles cover pixels, or one that is so much finer.
  VPM_HD int level_of_tiles(const PixelRectangle& p, int finer) const {
    const std::int32_t wide = p.u1 - p.u0, high = p.v1 - p.v0;
    const int level = exponent_of(static_cast<std::uint32_t>(wide > high ? wide : high)) - finer;
    return level < 0 ? 0 : level < levels ? level : levels - 1;
  }

  // Sets the range of the ball's pixels from at most 3 by 3 tiles.
  VPM_HD void cover(BallClass& in_ball) const {
    const PixelRectangle& p = in_ball.pixels;
    const int level = level_of_tiles(p, 0);
    const std::int32_t row = tiles_per_row(level);
    const std::int32_t u0 = p.u0 >> level, u1 = p.u1 >> level;
    const std::int32_t v0 = p.v0 >> level, v1 = p.v1 >> level;
    const std::int32_t u_end = (u1 + 1) << level, v_end = (v1 + 1) << level;
    in_ball.tiles = {u0 << level, v0 << level, (u_end < width ? u_end : width) - 1,
                     (v_end < height ? v_end : height) - 1};
    in_ball.middle = measured[(p.v0 + p.v1) / 2 * width + (p.u0 + p.u1) / 2];
    InverseDepthRange all = tiles[level][v0 * row + u0];
    const auto take = [&](std::int32_t u, std::int32_t v) {
      const InverseDepthRange tile = tiles[level][v * row + u];
      all = united(all, tile);
    };
    // Takes nine always, some twice: independent loads without branches.
    for (std::int32_t i = 0; i < 9; ++i)
      take(u0 + i % 3 < u1 ? u0 + i % 3 : u1, v0 + i / 3 < v1 ? v0 + i / 3 : v1);
    in_ball.range = all;
  }
};

}  // namespace vpm
