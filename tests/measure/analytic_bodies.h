// Bodies of the scene whose truth is plain: what the measure asks of any body, in few lines.
#pragma once

#include "libvpm/scene/ball_fraction.h"
#include "libvpm/scene/body.h"

namespace vpm::testing {

// A solid below a plane, without an end.
struct HalfSpace {
  static constexpr bool kTellsInside = false, kSearchesFoot = false;
  struct Look {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;
  };

  TangentPlane top;

  VPM_HD Look look_at_ball(Vec3 center, double radius) const {
    const double distance = top.distance(center);
    return {distance >= radius ? Side::free : distance <= -radius ? Side::uncut : Side::mixed};
  }
  VPM_HD Reading read(Vec3 x, std::uint32_t = kNoPoint) const {
    const double distance = top.distance(x);
    return {true, distance, top.normal, x - distance * top.normal};
  }
  VPM_HD Vec3 closest_normal(Vec3, const Reading& reading) const { return reading.normal; }
  VPM_HD bool may_be_flat(const Look&) const { return true; }
  template <class ReadAll>
  VPM_HD bool mean_plane(const Look&, Vec3, double, double, const ReadAll&,
                         TangentPlane& plane) const {
    plane = top;
    return true;
  }
  template <class Read>
  VPM_HD bool is_flat(const Look&, const Read&, double, TangentPlane& plane) const {
    plane = top;
    return true;
  }
  VPM_HD double fraction_inside(const Reading& reading, Vec3, double radius) const {
    return ball_fraction_inside(reading.distance / radius);
  }
  VPM_HD const HalfSpace& around_ball(Vec3, double, std::uint32_t) const { return *this; }
};

// Returns the half-space below the plane that faces along `normal`, `height` m from the origin.
inline HalfSpace below(Vec3 normal, double height) {
  const Vec3 unit = normalized_or_zero(normal);
  return {{unit, height * unit}};
}

// Asks two bodies at one place, as several cameras will be: what one of them shows to be free is
// free, so the greater distance counts.
template <class One, class Other>
struct Both {
  static constexpr bool kTellsInside = false, kSearchesFoot = false;
  struct Look {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;
    typename One::Look one;
    typename Other::Look other;
  };

  One one;
  Other other;

  VPM_HD Look look_at_ball(Vec3 center, double radius) const {
    Look look;
    look.one = one.look_at_ball(center, radius);
    look.other = other.look_at_ball(center, radius);
    const bool is_free = look.one.side == Side::free || look.other.side == Side::free;
    const bool is_mixed = look.one.side == Side::mixed || look.other.side == Side::mixed;
    look.side = is_free ? Side::free : is_mixed ? Side::mixed : Side::uncut;
    return look;
  }
  VPM_HD Reading read(Vec3 x, std::uint32_t = kNoPoint) const {
    const Reading a = one.read(x), b = other.read(x);
    return a.distance >= b.distance ? a : b;
  }
  VPM_HD Vec3 closest_normal(Vec3, const Reading& reading) const { return reading.normal; }
  // One plane only where the other body's surface does not pass.
  VPM_HD bool may_be_flat(const Look& look) const {
    return look.one.side != Side::mixed || look.other.side != Side::mixed;
  }
  template <class ReadAll>
  VPM_HD bool mean_plane(const Look& look, Vec3 center, double radius, double tolerance,
                         const ReadAll& read_all, TangentPlane& plane) const {
    if (!may_be_flat(look)) return false;
    return look.one.side == Side::mixed
               ? one.mean_plane(look.one, center, radius, tolerance, read_all, plane)
               : other.mean_plane(look.other, center, radius, tolerance, read_all, plane);
  }
  template <class Read>
  VPM_HD bool is_flat(const Look& look, const Read& read, double tolerance,
                      TangentPlane& plane) const {
    return look.one.side == Side::mixed ? one.is_flat(look.one, read, tolerance, plane)
                                        : other.is_flat(look.other, read, tolerance, plane);
  }
  VPM_HD double fraction_inside(const Reading& reading, Vec3, double radius) const {
    return ball_fraction_inside(reading.distance / radius);
  }
  VPM_HD const Both& around_ball(Vec3, double, std::uint32_t) const { return *this; }
};

static_assert(MeasuredBody<HalfSpace> && !SeesFreeSpace<HalfSpace> && !HasOtherWalls<HalfSpace>);
static_assert(MeasuredBody<Both<HalfSpace, HalfSpace>>);

}  // namespace vpm::testing
