// Defines bodies of the scene whose truth is analytic.
#pragma once

#include "libvpm/scene/body.h"

namespace vpm::testing {

// A solid below an endless plane.
struct HalfSpace {
  static constexpr bool kTellsInside = false, kSearchesFoot = false;
  struct BallClass {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;
  };

  TangentPlane top;

  VPM_HD BallClass classify_ball(Vec3 center, double radius) const {
    const double distance = top.distance(center);
    return {distance >= radius    ? Side::free
            : distance <= -radius ? Side::no_surface
                                  : Side::ambiguous};
  }
  VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t = kNoPoint) const {
    const double distance = top.distance(x);
    return {true, distance, top.normal, x - distance * top.normal};
  }
  VPM_HD Vec3 closest_normal(Vec3, const SurfaceSample& on_surface) const {
    return on_surface.normal;
  }
  VPM_HD bool may_be_flat(const BallClass&) const { return true; }
  template <class SampleAll>
  VPM_HD bool mean_plane(const BallClass&, Vec3, double, double, const SampleAll&,
                         TangentPlane& plane) const {
    plane = top;
    return true;
  }
  template <class Read>
  VPM_HD bool is_flat(const BallClass&, const Read&, double, TangentPlane& plane) const {
    plane = top;
    return true;
  }
  template <class Shape>
  VPM_HD double fraction_inside(const SurfaceSample& on_surface, Vec3, const Shape& shape) const {
    return fraction_behind(shape, on_surface.distance, on_surface.normal);
  }
  VPM_HD const HalfSpace& around_ball(Vec3, double, std::uint32_t) const { return *this; }
};

// Returns the half-space below the plane that faces along `normal`, `height` m from the origin.
inline HalfSpace below(Vec3 normal, double height) {
  const Vec3 unit = normalized_or_zero(normal);
  return {{unit, height * unit}};
}

// The same, of which places below the plane are known to be inside.
struct SeenHalfSpace : HalfSpace {
  static constexpr bool kTellsInside = true;
  VPM_HD const SeenHalfSpace& around_ball(Vec3, double, std::uint32_t) const { return *this; }
};
inline SeenHalfSpace seen_below(Vec3 normal, double height) {
  return {below(normal, height)};
}

// A solid below one plane and before another: a step. Beyond its side free space was seen, though
// the mean of the surface across a ball is the top.
struct Step {
  static constexpr bool kTellsInside = true, kSearchesFoot = false;
  struct BallClass {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;
    bool holds_free = false;
  };

  TangentPlane top, side;

  VPM_HD BallClass classify_ball(Vec3 center, double radius) const {
    const bool holds_free = side.distance(center) > -radius;
    const double height = top.distance(center);
    return {height >= radius                   ? Side::free
            : height <= -radius && !holds_free ? Side::behind
                                               : Side::ambiguous,
            kNoPoint, holds_free};
  }
  VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t = kNoPoint) const {
    const double height = top.distance(x), aside = side.distance(x);
    const TangentPlane& wall = aside > 0 && aside > height ? side : top;
    const double distance = wall.distance(x);
    return {true, distance, wall.normal, x - distance * wall.normal};
  }
  VPM_HD Vec3 closest_normal(Vec3, const SurfaceSample& on_surface) const {
    return on_surface.normal;
  }
  VPM_HD bool may_be_flat(const BallClass&) const { return true; }
  template <class SampleAll>
  VPM_HD bool mean_plane(const BallClass&, Vec3 center, double, double, const SampleAll&,
                         TangentPlane& plane) const {
    plane = {top.normal, center - top.distance(center) * top.normal};
    return true;
  }
  template <class Read>
  VPM_HD bool is_flat(const BallClass& in_ball, const Read&, double, TangentPlane& plane) const {
    plane = top;
    return !in_ball.holds_free;
  }
  template <class Shape>
  VPM_HD double fraction_inside(const SurfaceSample& on_surface, Vec3, const Shape& shape) const {
    return fraction_behind(shape, on_surface.distance, on_surface.normal);
  }
  VPM_HD const Step& around_ball(Vec3, double, std::uint32_t) const { return *this; }

  VPM_HD bool is_beside(Vec3 center, double radius) const {
    return side.distance(center) >= radius;
  }
  VPM_HD Side side_of(const BallClass& in_ball, Vec3 center, double radius) const {
    return is_beside(center, radius) ? Side::free : in_ball.side;
  }
  VPM_HD bool tells_of_parts(Vec3, double) const { return true; }
  VPM_HD bool is_free_part(const BallClass&, Vec3 center, double radius) const {
    return is_beside(center, radius) || top.distance(center) >= radius;
  }
  static VPM_HD float least_inverse_depth(const BallClass&) { return 0; }
  VPM_HD bool may_be_free(float, Vec3 center, double radius) const {
    return is_beside(center, radius);
  }
  VPM_HD bool may_hold_free(const BallClass&, Vec3 center, double radius) const {
    return side.distance(center) > -radius;
  }
};

// Asks two bodies at one place, as several cameras will be: what one shows to be free is free, so
// the greater distance counts.
template <class One, class Other>
struct Both {
  static constexpr bool kTellsInside = false, kSearchesFoot = false;
  struct BallClass {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;
    typename One::BallClass one;
    typename Other::BallClass other;
  };

  One one;
  Other other;

  VPM_HD BallClass classify_ball(Vec3 center, double radius) const {
    BallClass in_ball;
    in_ball.one = one.classify_ball(center, radius);
    in_ball.other = other.classify_ball(center, radius);
    const bool is_free = in_ball.one.side == Side::free || in_ball.other.side == Side::free;
    const bool is_mixed =
        in_ball.one.side == Side::ambiguous || in_ball.other.side == Side::ambiguous;
    in_ball.side = is_free ? Side::free : is_mixed ? Side::ambiguous : Side::no_surface;
    return in_ball;
  }
  VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t = kNoPoint) const {
    const SurfaceSample a = one.sample(x), b = other.sample(x);
    return a.distance >= b.distance ? a : b;
  }
  VPM_HD Vec3 closest_normal(Vec3, const SurfaceSample& on_surface) const {
    return on_surface.normal;
  }
  // May be one plane only where the other body's surface does not pass.
  VPM_HD bool may_be_flat(const BallClass& in_ball) const {
    if (in_ball.one.side == Side::ambiguous && in_ball.other.side == Side::ambiguous) return false;
    return in_ball.one.side == Side::ambiguous ? one.may_be_flat(in_ball.one)
                                               : other.may_be_flat(in_ball.other);
  }
  template <class SampleAll>
  VPM_HD bool mean_plane(const BallClass& in_ball, Vec3 center, double radius, double tolerance,
                         const SampleAll& sample_all, TangentPlane& plane) const {
    return in_ball.one.side == Side::ambiguous
               ? one.mean_plane(in_ball.one, center, radius, tolerance, sample_all, plane)
               : other.mean_plane(in_ball.other, center, radius, tolerance, sample_all, plane);
  }
  template <class Read>
  VPM_HD bool is_flat(const BallClass& in_ball, const Read& read, double tolerance,
                      TangentPlane& plane) const {
    return in_ball.one.side == Side::ambiguous
               ? one.is_flat(in_ball.one, read, tolerance, plane)
               : other.is_flat(in_ball.other, read, tolerance, plane);
  }
  template <class Shape>
  VPM_HD double fraction_inside(const SurfaceSample& on_surface, Vec3, const Shape& shape) const {
    return fraction_behind(shape, on_surface.distance, on_surface.normal);
  }
  VPM_HD const Both& around_ball(Vec3, double, std::uint32_t) const { return *this; }
};

static_assert(MeasuredBody<HalfSpace> && !SeesFreeSpace<HalfSpace> && !HasOtherWalls<HalfSpace>);
static_assert(MeasuredBody<SeenHalfSpace> && !SeesFreeSpace<SeenHalfSpace>);
static_assert(SeesFreeSpace<Step> && !SharesPixels<Step>);
static_assert(MeasuredBody<Both<HalfSpace, HalfSpace>>);

}  // namespace vpm::testing
