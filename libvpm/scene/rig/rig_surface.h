// Defines the surface that several cameras see together, and classifies balls by it, of which each
// camera tells a part. README.md has the reasons.
#pragma once

#include "libvpm/scene/mean_plane.h"
#include "libvpm/scene/rig/rig_sampler.h"

namespace vpm {

// Holds plain pointers to a rig's data, for host or device.
struct RigSurface : RigSampler {
  static constexpr bool kSearchesFoot = true;
  static constexpr bool kTellsInside = true;

  // Holds the class of a ball: the cameras that tell of places in it, and what they tell.
  struct BallClass {
    Side side = Side::free;
    CameraSet point = 0;  // the cameras that decide there
    Sight sight = Sight::out_of_view;
    bool is_whole = false;  // all pixels of these cameras have measured a surface
    double gap = HUGE_VAL;  // m, bounds how far places of a ball behind the surface are from it
    double margin = 0;      // m, bounds the distances within which readings in it are averaged
    Vec3 center;
    double radius = 0;
  };

  // The surface as a set of cameras sees it.
  struct View {
    const RigSurface* rig = nullptr;
    CameraSet cameras = 0;

    VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t = kNoPoint) const {
      return sample_within(x, HUGE_VAL);
    }
    VPM_HD SurfaceSample sample_within(Vec3 x, double reach, std::uint32_t = kNoPoint) const {
      return rig->sample_near(x, cameras, reach);
    }
  };

  // Samples the surface, as the cameras see it that decide in a ball about x: kNoPoint are all.
  VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t point = kNoPoint) const {
    return sample_within(x, HUGE_VAL, point);
  }
  // Samples the surface for a piece that reaches so far, m. Of one further before the surface only
  // that is told; it is unknown if nothing was measured there.
  VPM_HD SurfaceSample sample_within(Vec3 x, double reach, std::uint32_t point = kNoPoint) const {
    return sample_near(x, point & all_cameras(), reach);
  }
  VPM_HD View around_ball(Vec3, double, std::uint32_t point) const {
    return {this, point & all_cameras()};
  }

  static VPM_HD Sight sight_of(const BallClass& in_ball) { return in_ball.sight; }

  // Classifies a ball. It is free where one camera has seen all of a ball free that is larger by
  // the distance within which readings are averaged: that camera's distances are then half of this
  // or more, bound or not, and no mean with one behind is behind. It is behind where it is so for
  // all cameras that see it.
  VPM_HD BallClass classify_ball(Vec3 center, double radius) const {
    BallClass in_ball;
    in_ball.center = center, in_ball.radius = radius;
    in_ball.margin = most_agreement * (greatest_depth(center) + radius);
    CameraSet deciding = 0, behind = 0, hidden = 0;
    Sight sight = Sight::out_of_view;
    bool is_whole = true;
    for (std::int32_t i = 0; i < count; ++i) {
      const DepthSurface& image = cameras[i].image;
      const Vec3 at = cameras[i].from_rig * center;
      const DepthSurface::BallClass own = class_of(image, at, radius);
      const Sight of_camera = DepthSurface::sight_of(own);
      if (of_camera == Sight::out_of_view) continue;
      if (own.side == Side::free && of_camera == Sight::seen && is_seen_free(image, at, in_ball))
        return free_ball(in_ball, Sight::seen);
      sight = joined(sight, of_camera);
      if (of_camera == Sight::hole && !has_fits(cameras[i], own)) continue;
      const CameraSet bit = CameraSet{1} << i;
      in_ball.point |= bit;
      deciding |=
          own.side == Side::free && !may_be_behind_fit(cameras[i], own, at, radius) ? 0 : bit;
      if (own.side == Side::behind) {
        behind |= bit;
        if (is_hidden(cameras[i], own, at, radius)) hidden |= bit;
        const double gap = image.largest_gap(own, at, radius) + in_ball.margin;
        in_ball.gap = gap < in_ball.gap ? gap : in_ball.gap;
      } else {
        is_whole = is_whole && image.may_be_flat(own);
      }
    }
    if (deciding == 0) return free_ball(in_ball, sight);
    in_ball.sight = Sight::mixed;
    in_ball.side = behind == in_ball.point ? Side::behind : Side::ambiguous;
    if (in_ball.side == Side::ambiguous) in_ball.point &= ~hidden;
    in_ball.is_whole = is_whole;
    return in_ball;
  }

  // Returns the side of a classified ball, of which a camera's own pixels may show all free.
  VPM_HD Side side_of(const BallClass& in_ball, Vec3 center, double radius) const {
    if (in_ball.side != Side::ambiguous) return in_ball.side;
    const double wider = radius + margin_of(in_ball);
    for (std::int32_t i = 0; i < count; ++i) {
      if ((in_ball.point >> i & 1) == 0) continue;
      const DepthSurface& image = cameras[i].image;
      const Vec3 at = cameras[i].from_rig * center;
      const DepthSurface::BallClass own = image.classify_ball(at, wider);
      if (image.may_be_flat(own) && image.side_of(own, at, wider) == Side::free) return Side::free;
    }
    return in_ball.side;
  }
  // True: the class of a ball holds for all balls in it.
  VPM_HD bool tells_of_parts(Vec3, double) const { return true; }
  // Leaves it to classify_ball() of the part.
  VPM_HD bool is_free_part(const BallClass& in_ball, Vec3, double) const {
    return in_ball.side == Side::free;
  }
  // Returns 0: each camera has its own depth.
  static VPM_HD float least_inverse_depth(const BallClass&) { return 0; }
  VPM_HD bool may_be_free(float least, Vec3 center, double radius) const {
    for (std::int32_t i = 0; i < count; ++i)
      if (cameras[i].image.may_be_free(least, cameras[i].from_rig * center, radius)) return true;
    return false;
  }
  VPM_HD bool may_hold_free(const BallClass& in_ball, Vec3 center, double radius) const {
    for (std::int32_t i = 0; i < count; ++i) {
      if ((in_ball.point >> i & 1) == 0) continue;
      const DepthSurface& image = cameras[i].image;
      const Vec3 at = cameras[i].from_rig * center;
      if (image.may_hold_free(image.classify_ball(at, radius), at, radius)) return true;
    }
    return false;
  }

  VPM_HD bool may_be_flat(const BallClass& in_ball) const { return in_ball.is_whole; }
  template <class Read>
  VPM_HD bool is_flat(const BallClass& in_ball, const Read& read, double tolerance,
                      TangentPlane& plane) const {
    const SurfaceSample on_surface = read();
    if (!on_surface.known) return false;
    plane = {on_surface.normal, on_surface.foot};
    return show(in_ball, plane, tolerance);
  }
  template <class SampleAll>
  VPM_HD bool mean_plane(const BallClass& in_ball, Vec3 center, double radius, double tolerance,
                         const SampleAll& sample_all, TangentPlane& plane) const {
    const View view{this, in_ball.point};
    return mean_of_five(view, center, radius, DepthSampler::kSmoothCosine, sample_all, plane) &&
           show(in_ball, plane, tolerance);
  }
  VPM_HD double largest_gap(const BallClass& in_ball, Vec3, double) const { return in_ball.gap; }

  template <class Shape>
  static VPM_HD double fraction_inside(const SurfaceSample& on_surface, Vec3, const Shape& shape) {
    return fraction_behind(shape, on_surface.distance, on_surface.normal);
  }

 private:
  static constexpr double kRounding = 1 + 1e-9;  // far above what sums err by

  // True if a plane about the middle of a ball is that which each camera that decides there sees.
  VPM_HD bool show(const BallClass& in_ball, const TangentPlane& plane, double tolerance) const {
    for (std::int32_t i = 0; i < count; ++i) {
      if ((in_ball.point >> i & 1) == 0) continue;
      const RigCamera& camera = cameras[i];
      const Vec3 at = camera.from_rig * in_ball.center;
      const SurfaceSample seen = camera.image.sample(at);
      const Vec3 normal = camera.from_rig.rotation * plane.normal;
      if (!seen.known || dot(seen.normal, normal) < DepthSampler::kSmoothCosine) return false;
      const double apart = dot(normal, seen.foot - camera.from_rig * plane.foot);
      if (!(std::fabs(apart) < in_ball.margin)) return false;
      if (!camera.image.shows(camera.image.classify_ball(at, in_ball.radius),
                              TangentPlane{normal, seen.foot}, tolerance))
        return false;
    }
    return true;
  }

  // Returns the class of a ball before one camera, decided by the plane at its middle too: samples
  // of a rig take many times as long.
  static VPM_HD DepthSurface::BallClass class_of(const DepthSurface& image, Vec3 at,
                                                 double radius) {
    DepthSurface::BallClass own = image.classify_ball(at, radius);
    own.side = image.side_by_plane(own, at, radius);
    return own;
  }
  // True if the fits of a camera's holes may tell of places in a ball.
  static VPM_HD bool has_fits(const RigCamera& camera, const DepthSurface::BallClass& own) {
    return camera.silhouettes.holes.numbers != nullptr &&
           camera.silhouettes.may_be_near(own.pixels);
  }
  // True if places in a ball may be behind the fits of a camera's holes.
  static VPM_HD bool may_be_behind_fit(const RigCamera& camera, const DepthSurface::BallClass& own,
                                       Vec3 at, double radius) {
    return DepthSurface::sight_of(own) != Sight::seen && has_fits(camera, own) &&
           camera.silhouettes.holes.may_be_behind(own.pixels, at.z + radius);
  }
  // True if a camera has seen all of a larger ball free, so that no mean of readings in the ball is
  // behind the surface.
  static VPM_HD bool is_seen_free(const DepthSurface& image, Vec3 at, const BallClass& in_ball) {
    const DepthSurface::BallClass wider = class_of(image, at, in_ball.radius + in_ball.margin);
    return wider.side == Side::free && DepthSurface::sight_of(wider) == Sight::seen;
  }
  // True if a camera that has all of a ball behind what it sees has that well before each place in
  // it, and no silhouette beside.
  VPM_HD bool is_hidden(const RigCamera& camera, const DepthSurface::BallClass& own, Vec3 at,
                        double radius) const {
    const double nearest = at.z - radius, farthest = at.z + radius;
    return nearest - quotient(1, own.range.low) > kRounding * well_before * farthest &&
           !camera.silhouettes.may_be_near(own.pixels);
  }
  static VPM_HD BallClass free_ball(BallClass in_ball, Sight sight) {
    in_ball.side = Side::free;
    in_ball.sight = sight;
    return in_ball;
  }
  // Returns what is seen of a ball of which one camera sees this and others that; none of them has
  // it out of view, but the first at the start.
  static VPM_HD Sight joined(Sight so_far, Sight next) {
    if (so_far == Sight::seen || next == Sight::seen) return Sight::seen;
    if (so_far == Sight::mixed || next == Sight::mixed) return Sight::mixed;
    return Sight::hole;
  }
  // Returns by how much more than a ball a camera must have seen free: nothing where it is alone.
  static VPM_HD double margin_of(const BallClass& in_ball) {
    return (in_ball.point & (in_ball.point - 1)) == 0 ? 0 : in_ball.margin;
  }
  // Returns the greatest depth, m, that a place has to a camera; 0 if it is before none.
  VPM_HD double greatest_depth(const Vec3& x) const {
    double greatest = 0;
    for (std::int32_t i = 0; i < count; ++i) {
      const double depth = (cameras[i].from_rig * x).z;
      greatest = depth > greatest ? depth : greatest;
    }
    return greatest;
  }
};

}  // namespace vpm
