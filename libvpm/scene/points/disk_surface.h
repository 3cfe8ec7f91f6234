// Defines the surface of an unorganised cloud: disks (point, normal, sampling radius) in a bounding
// volume hierarchy. The nearest disk decides on which side a place lies. Places are in the cloud's
// frame, about its origin.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/scene/body.h"
#include "libvpm/scene/points/disk_winding.h"
#include "libvpm/scene/points/point_tree.h"

namespace vpm {

// Holds four nodes' cones: each normal of a node has at least the cosine `cosine` with its `axis`.
struct alignas(16) ConeQuad {
  float axis[3][4] = {};
  float cosine[4] = {};

  void set(std::uint32_t k, Vec3f axis_of_k, float cosine_of_k) {
    axis[0][k] = axis_of_k.x, axis[1][k] = axis_of_k.y, axis[2][k] = axis_of_k.z;
    cosine[k] = cosine_of_k;
  }
};

// Points to the cones of a tree, one per node.
struct NormalCones {
  const ConeQuad* quads = nullptr;  // node k is entry k % 4 of quad k / 4

  // True only if each normal of a node surely has a cosine above `least` with the unit vector n.
  VPM_HD bool are_within(std::uint32_t node, Vec3 n, double least) const {
    constexpr double kSlack = 1e-3;  // far above the rounding of float axes
    const ConeQuad& quad = quads[node / 4];
    const std::uint32_t k = node % 4;
    const double cosine = quad.cosine[k],
                 off = dot({quad.axis[0][k], quad.axis[1][k], quad.axis[2][k]}, n);
    // Uses cos(a + b) = cos a cos b - sin a sin b; the last term is known by its square.
    const double above = off * cosine - (least + kSlack);
    return off > 0 && cosine > 0 && above > 0 &&
           above * above > (1 - off * off) * (1 - cosine * cosine);
  }
};

// Describes a second plane at a disk: the solid lies behind both (a convex edge, a thin plate), or
// behind either of them (a concave edge, a slot).
struct SecondPlane {
  Vec3f normal, foot;
  bool is_convex = false;

  VPM_HD TangentPlane plane() const { return {widen(normal), widen(foot)}; }
};

// Holds plain pointers to a cloud's data, for host or device.
struct DiskSurface {
  static constexpr bool kTellsInside = false;   // disks may be seen from anywhere
  static constexpr bool kSearchesFoot = false;  // the sampled disk is the nearest

  PointTree feet;  // in canonical order
  const Vec3f* normals = nullptr;
  const std::uint32_t* second_of = nullptr;  // per disk: index into seconds, or kNoPoint
  const SecondPlane* seconds = nullptr;
  PointNumbers radii{};
  NormalCones cones{};
  DiskWinding winding{};
  // Per disk: the point before denoising, which moved it; null for points as measured, and on a
  // device, where nobody asks.
  const Vec3f* measured = nullptr;

  // Samples the nearest disk, which stands for the surface. Only in an empty cloud nothing is
  // known.
  VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t near = kNoPoint) const {
    return sample_of_point(x, feet.nearest(x, HUGE_VAL, near));
  }
  // Samples four places by one search. Host only.
  void sample_four(const Vec3 (&places)[4], std::uint32_t near,
                   SurfaceSample (&on_surface_at)[4]) const {
    std::uint32_t found[4] = {kNoPoint, kNoPoint, kNoPoint, kNoPoint};
    if (feet.count > 0) feet.nearest_of_four(places, near, found);
    for (int k = 0; k < 4; ++k) on_surface_at[k] = sample_of_point(places[k], found[k]);
  }
  VPM_HD SurfaceSample sample_of_point(Vec3 x, std::uint32_t i) const {
    if (i == kNoPoint) return {};
    const TangentPlane own = plane_of(i);
    const double distance = own.distance(x);
    if (knows_second(i)) {
      const SecondPlane& second = second_at(i);
      const TangentPlane beyond = second.plane();
      const double other = beyond.distance(x);
      if (second.is_convex ? other > distance : other < distance)
        return {true, other, beyond.normal, beyond.foot, i};
    }
    return {true, distance, own.normal, own.foot, i};
  }

  // Returns the part of a piece about x that is behind the surface sampled there.
  template <class Shape>
  VPM_HD double fraction_inside(const SurfaceSample& on_surface, Vec3 x, const Shape& shape) const {
    if (!knows_second(on_surface.point))
      return fraction_behind(shape, on_surface.distance, on_surface.normal);
    const SecondPlane& second = second_at(on_surface.point);
    const TangentPlane own = plane_of(on_surface.point), beyond = second.plane();
    const double first_inside = fraction_behind(shape, own.distance(x), own.normal);
    const double second_inside = fraction_behind(shape, beyond.distance(x), beyond.normal);
    const double cosine = dot(own.normal, beyond.normal);
    return second.is_convex ? fraction_of_both(first_inside, second_inside, cosine)
                            : 1 - fraction_of_both(1 - first_inside, 1 - second_inside, cosine);
  }

  // Returns a sampler for places in a ball, which lists the points that may be nearest to one of
  // them if they are few. `near` is a point near the centre.
  class AroundBall;
  VPM_HD AroundBall around_ball(Vec3 center, double radius, std::uint32_t near) const;

  // Returns the gradient of the distance to the nearest disk at a place x behind it: the disk's
  // normal above the disk, toward its rim beside it (at a crease, where the gradient fans out). A
  // disk that knows both sides of a groove gives the direction to these, or to their crease.
  VPM_HD Vec3 closest_normal(Vec3 x, const SurfaceSample& on_surface) const {
    if (knows_second(on_surface.point) && !second_at(on_surface.point).is_convex) {
      const TangentPlane own = plane_of(on_surface.point),
                         other = second_at(on_surface.point).plane();
      const bool below_both = own.distance(x) < 0 && other.distance(x) < 0;
      return below_both && dot(own.normal, other.normal) > kSlot
                 ? normal_below_groove(x, own, other)
                 : on_surface.normal;
    }
    const Vec3 towards = on_surface.foot - x;
    const double height = dot(on_surface.normal, towards);
    const Vec3 aside = towards - height * on_surface.normal;
    const double aside_squared = squared_norm(aside), rim = rim_of(on_surface.point);
    if (height > 0 && aside_squared <= rim * rim) return on_surface.normal;
    return normalized_or_zero(towards - (rim / std::sqrt(aside_squared)) * aside);
  }

  // Returns the plane of the other side of a plate or slot, if the sampled disk knows it.
  std::optional<TangentPlane> other_side(const SurfaceSample& sampled) const {
    if (!knows_second(sampled.point)) return std::nullopt;
    const TangentPlane own = plane_of(sampled.point), second = second_at(sampled.point).plane();
    if (dot(own.normal, second.normal) > kSlot) return std::nullopt;
    return dot(own.normal, sampled.normal) > 0 ? second : own;
  }

  // Calls visit(normal) for each plane that a disk knows.
  template <class Visit>
  VPM_HD void for_normals_of(std::uint32_t i, const Visit& visit) const {
    visit(widen(normals[i]));
    if (knows_second(i)) visit(widen(second_at(i).normal));
  }
  // True if all planes known to disks in a ball face the way of n, with a cosine above `least`.
  VPM_HD bool face_one_way(Vec3 center, double radius, Vec3 n, double least) const {
#ifdef __CUDA_ARCH__
    return face_one_way_by<PointTree::OneByOne>(center, radius, n, least);
#else
    return face_one_way_by_vectors(center, radius, n, least);
#endif
  }

  // Finds a second wall near a body of this radius about x. `own` is the wall that x is nearest to,
  // `point` a point of it. Asks which disk is nearest at four places, to four sides of x and
  // further behind `own`. Walls count whose normals have a cosine below `unlike` with that of
  // `own`; of these it keeps the one whose border with `own` leaves it the largest part of the
  // body. Returns false if there is none: beyond the last point of a cloud there is no wall.
  VPM_HD bool find_other_wall(Vec3 x, const TangentPlane& own, std::uint32_t point, double radius,
                              double unlike, OtherWall& other) const;

  // Return whether the disks enclose any place, and this one: more of all directions than not lead
  // to the back of a disk.
  VPM_HD bool may_enclose() const {
    return winding.may_enclose;
  }
  VPM_HD bool encloses(Vec3 x) const {
    return winding.at(x) > 0.5;
  }

  // Holds the class of a ball. Disks bound no gap.
  struct BallClass {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;  // nearest to the centre, if any disk touches the ball
    Vec3 center;
    double radius = 0;
  };
  VPM_HD BallClass classify_ball(Vec3 center, double radius) const {
    return class_by_point(feet.nearest_touching(center, radius, radii), center, radius);
  }
  // Returns the class of a ball whose nearest touching point is known.
  VPM_HD static BallClass class_by_point(std::uint32_t point, Vec3 center, double radius) {
    return {point == kNoPoint ? Side::no_surface : Side::ambiguous, point, center, radius};
  }
  // True if nobody knows whether a ball of which nothing counts is inside. If no disk touches it,
  // that is so where its middle is behind the nearest disk and either more directions lead to backs
  // of disks than outside of a closed surface, or the disks are walls about free space. If one
  // does, the winding number is not exact, but the middle is surely behind that disk or not. A ball
  // without surface may have a point near it, where the search begins.
  VPM_HD bool is_unknown(const BallClass& in_ball) const {
    const Vec3 x = in_ball.center;
    if (in_ball.side != Side::no_surface)
      return is_well_behind(x, sample_of_point(x, in_ball.point));
    const SurfaceSample nearest =
        sample(x, in_ball.point != kNoPoint ? in_ball.point : feet.entry.nearest);
    if (!nearest.known) return true;
    return nearest.distance < 0 && (winding.at(x) > DiskWinding::kMayBeInside ||
                                    (winding.may_surround && is_well_behind(x, nearest)));
  }
  VPM_HD bool may_be_flat(const BallClass& in_ball) const {
    return in_ball.point != kNoPoint;
  }
  template <class Read>
  VPM_HD bool is_flat(const BallClass& in_ball, const Read&, double tolerance,
                      TangentPlane& plane) const {
    return mean_plane(in_ball, tolerance, plane);
  }
  template <class SampleAll>
  VPM_HD bool mean_plane(const BallClass& in_ball, Vec3, double, double tolerance, const SampleAll&,
                         TangentPlane& plane) const {
    return mean_plane(in_ball, tolerance, plane);
  }
  // Finds the mean plane of the disks below a ball that may_be_flat(). Returns false where they do
  // not show one smooth surface: one is of another wall or lies off the plane by more than
  // kOffPlane of `tolerance`, or those on one side of the middle are too few or face elsewhere.
  VPM_HD bool mean_plane(const BallClass& in_ball, double tolerance, TangentPlane& plane) const {
    const SurfaceSample nearest = sample_of_point(in_ball.center, in_ball.point);
    const double height = nearest.distance, near = kMiddle * in_ball.radius;
    const Vec3 middle = in_ball.center - height * nearest.normal;
    Vec3 normal_sum, place_sum;
    std::uint32_t found = 0;
    const bool few = feet.for_points_in_ball(middle, near * near, [&](std::uint32_t i) {
      normal_sum += widen(normals[i]);
      place_sum += widen(feet.points[i]);
      return ++found <= kMostOfPatch;
    });
    if (!few || found == 0) return false;
    plane = {normalized_or_zero(normal_sum), 1.0 / found * place_sum};
    return shows(plane, middle, in_ball.center, in_ball.radius * in_ball.radius + height * height,
                 kOffPlane * tolerance);
  }

 private:
  static constexpr std::uint32_t kMostOfPatch =
      1024;  // points; with more, asking cell by cell is faster
  static constexpr std::uint32_t kFewestAside = 3;  // disks in each quarter about the middle
  static constexpr double kSmoothCosine = 0.9;      // as in an image
  // Disks that face elsewhere by more than 60 degrees are of another wall. At 90 noise would decide
  // which disks of a perpendicular wall are.
  static constexpr double kOtherWall = 0.5;
  // Part of a ball's radius whose disks give the mean plane: over these a paraboloid has the mean
  // height that it has over a cube in the ball.
  static constexpr double kMiddle = 0.65;
  static constexpr double kOffPlane = 0.5;  // largest distance of a disk from it, in tolerances
  // Other walls are searched this many radii to the side, and as many further behind.
  static constexpr double kFurther = 0.85;
  static constexpr double kFarthestPlace = 1.21;  // radii from the middle; above sqrt(2) kFurther
  // The wall beyond a border is searched again this many radii from it.
  static constexpr double kBeyondBorder = 0.2;
  // Radius of a disk's rim, in sampling radii: so wide that noise leaves no gaps between disks.
  static constexpr double kRim = 3;
  static constexpr double kSlot = -0.8;       // largest cosine between the sides of a slot
  static constexpr double kWellBehind = 0.5;  // least cosine, as between two walls

  // True if the way from a place behind the nearest disk to it meets its back rather than its rim:
  // the plane of a disk at the rim of a scan goes on where nothing was seen.
  VPM_HD static bool is_well_behind(Vec3 x, const SurfaceSample& nearest) {
    return -nearest.distance > kWellBehind * norm(nearest.foot - x);
  }

  template <class Distances>
  VPM_HD bool face_one_way_by(Vec3 center, double radius, Vec3 n, double least) const {
    const double squared_radius = radius * radius;
    return feet.for_leaves_in_ball<Distances>(
        center, squared_radius,
        [&](std::uint32_t node) { return !cones.are_within(node, n, least); },
        [&](std::uint32_t begin, std::uint32_t end) {
          bool all = true;
          for (std::uint32_t i = begin; all && i < end; ++i) {
            if (squared_norm(widen(feet.points[i]) - center) > squared_radius) continue;
            for_normals_of(i, [&](Vec3 normal) { all &= dot(normal, n) > least; });
          }
          return all;
        });
  }
  bool face_one_way_by_vectors(Vec3 center, double radius, Vec3 n, double least) const;

  VPM_HD TangentPlane plane_of(std::uint32_t i) const {
    return {widen(normals[i]), widen(feet.points[i])};
  }
  VPM_HD double rim_of(std::uint32_t i) const {
    return kRim * radii.of_points[i];
  }
  // Asks by an index, not by a pointer: code by nvcc 13.0 for sm_90 was seen to read through a null
  // pointer after checking it.
  VPM_HD bool knows_second(std::uint32_t i) const {
    return second_of[i] != kNoPoint;
  }
  VPM_HD const SecondPlane& second_at(std::uint32_t i) const {
    return seconds[second_of[i]];
  }

  // False if no other wall than `own` can be nearest to places where one is searched.
  VPM_HD bool may_meet_other_wall(Vec3 x, const TangentPlane& own, std::uint32_t point,
                                  double radius, double unlike) const {
    const double away = kFurther * radius, depth = away - own.distance(x);
    return depth > 0 &&
           !face_one_way(x - away * own.normal, depth + away + rim_of(point), own.normal, unlike);
  }
  // Chooses another wall for find_other_wall(); `near` samples the surface about its places.
  template <class Near>
  VPM_HD bool choose_other_wall(const Near& near, Vec3 x, const TangentPlane& own,
                                std::uint32_t point, double radius, double unlike,
                                OtherWall& other) const {
    const Vec3 side = normalized_or_zero(cross(own.normal, axis_aside(own.normal))),
               across = cross(own.normal, side);
    const Vec3 asides[4] = {side, -1.0 * side, across, -1.0 * across};
    const auto place_of = [&](int k) { return x + kFurther * radius * (asides[k] - own.normal); };
    double least = radius;
    OtherWall wall;
    const auto take = [&](Vec3 place, const SurfaceSample& there) {
      double away = 0;
      if (!find_border(place, there, x, own, unlike, wall, away) || !(away < least)) return;
      least = away > 0 ? away : 0;
      other = wall;
    };
#ifdef __CUDA_ARCH__
    for (int k = 0; k < 4; ++k) take(place_of(k), near.sample(place_of(k), point));
#else
    const Vec3 places[4] = {place_of(0), place_of(1), place_of(2), place_of(3)};
    SurfaceSample there[4];
    near.sample_four(places, point, there);
    for (int k = 0; k < 4; ++k) take(places[k], there[k]);
#endif
    if (!(least < radius)) return false;
    // Searches beyond the border: there a wall may end at a crease.
    const Vec3 beyond = other.border.foot - kBeyondBorder * radius * other.border.normal;
    if (!find_border(beyond, near.sample(beyond, point), x, own, unlike, wall, least)) return true;
    other = wall;
    return least < radius;
  }
  // Finds the border between `own` and the wall nearest to a place, whose surface sample is
  // `there`, and its distance `away` from x, m. Returns false and changes nothing if that wall does
  // not face elsewhere.
  VPM_HD bool find_border(Vec3 place, const SurfaceSample& there, Vec3 x, const TangentPlane& own,
                          double unlike, OtherWall& other, double& away) const {
    if (!(there.distance < 0)) return false;
    const Vec3 normal = closest_normal(place, there);
    if (dot(normal, own.normal) > unlike) return false;
    const Vec3 between = own.normal - normal;
    away = (own.distance(x) - dot(normal, x - there.foot)) / norm(between);
    other.normal = normal;
    other.border.normal = normalized_or_zero(between);
    other.border.foot = x - away * other.border.normal;
    return true;
  }

  // True if the disks in a ball show this plane: none lies off it or faces another way, and each of
  // the four quarters about `middle`, a place of the plane, has enough of them that face its way.
  VPM_HD bool shows(const TangentPlane& plane, Vec3 middle, Vec3 center, double squared_radius,
                    double tolerance) const {
    const Vec3 n = plane.normal;
    const Vec3 side = cross(n, axis_aside(n)), other = cross(n, side);
    Vec3 sums[4];
    std::uint32_t counts[4] = {};
    std::uint32_t found = 0;
    const bool agree = feet.for_points_in_ball(center, squared_radius, [&](std::uint32_t i) {
      const Vec3 place = widen(feet.points[i]), away = place - middle, normal = widen(normals[i]);
      const int aside = (dot(away, side) > 0 ? 1 : 0) + (dot(away, other) > 0 ? 2 : 0);
      sums[aside] += normal;
      ++counts[aside];
      return ++found <= kMostOfPatch && dot(normal, n) > kOtherWall &&
             std::fabs(plane.distance(place)) <= tolerance;
    });
    for (int k = 0; agree && k < 4; ++k) {
      if (counts[k] < kFewestAside || dot(normalized_or_zero(sums[k]), n) < kSmoothCosine)
        return false;
    }
    return agree;
  }
};

// Searches the points that may be nearest to places in a ball as a list, which is faster than the
// tree. Results have the same bits.
class DiskSurface::AroundBall {
 public:
  VPM_HD AroundBall(const DiskSurface& surface, Vec3 center, double radius, std::uint32_t near)
      : surface_(surface), center_(center) {
    if (near == kNoPoint) return;
    const double covered = kSlack * radius;
    const double distance = norm(widen(surface.feet.points[near]) - center);
    if (are_many(near, covered * (distance + covered))) return;
    radius_ = covered;
    const double reach = kSlack * (distance + 2 * covered);
    gather(reach * reach);
  }

  VPM_HD SurfaceSample sample(Vec3 x, std::uint32_t near) const {
    if (points_.is_empty() || !(squared_norm(x - center_) <= radius_ * radius_))
      return surface_.sample(x, near);
    return surface_.sample_of_point(x, points_.nearest(x));
  }
  // Samples four places. Host only.
  void sample_four(const Vec3 (&places)[4], std::uint32_t near,
                   SurfaceSample (&on_surface_at)[4]) const {
    if (points_.is_empty()) return surface_.sample_four(places, near, on_surface_at);
    for (int k = 0; k < 4; ++k) on_surface_at[k] = sample(places[k], near);
  }
  VPM_HD bool find_other_wall(Vec3 x, const TangentPlane& own, std::uint32_t point, double radius,
                              double unlike, OtherWall& other) const {
    if (!covers(x, kFarthestPlace * radius))
      return surface_.find_other_wall(x, own, point, radius, unlike, other);
    return surface_.may_meet_other_wall(x, own, point, radius, unlike) &&
           surface_.choose_other_wall(*this, x, own, point, radius, unlike, other);
  }

 private:
  static constexpr double kSlack = 1 + 1e-9;  // more than distances are rounded by

  VPM_HD bool covers(Vec3 x, double radius) const {
    return !points_.is_empty() && norm(x - center_) + radius <= radius_;
  }

  // Estimates whether more points than a list holds may be nearest: those on a disk of the surface
  // about the foot of the centre, whose squared radius is four times `quarter`, m^2, at the density
  // of the leaf of a near point.
  VPM_HD bool are_many(std::uint32_t near, double quarter) const {
    const PointBox leaf = surface_.feet.leaf_of(near);
    const double squared_diagonal = squared_norm(widen(leaf.high) - widen(leaf.low));
    const double area = 12 * quarter, area_of_leaf = 0.5 * squared_diagonal;  // roughly
    return area * PointTree::kLeafSize > 2 * PointList::kMost * area_of_leaf;
  }

  // Gathers the points that may be nearest; none if they are more than PointList::kMost.
  VPM_HD void gather(double squared_reach) {
    const bool few = surface_.feet.for_points_in_ball(center_, squared_reach, [&](std::uint32_t i) {
      return points_.add(i, surface_.feet.points[i]);
    });
    if (!few) points_.clear();
  }

  const DiskSurface& surface_;
  Vec3 center_;
  double radius_ = 0;
  PointList points_;
};

VPM_HD inline DiskSurface::AroundBall DiskSurface::around_ball(Vec3 center, double radius,
                                                               std::uint32_t near) const {
  return {*this, center, radius, near};
}

VPM_HD inline bool DiskSurface::find_other_wall(Vec3 x, const TangentPlane& own,
                                                std::uint32_t point, double radius, double unlike,
                                                OtherWall& other) const {
  if (!may_meet_other_wall(x, own, point, radius, unlike)) return false;
  return choose_other_wall(*this, x, own, point, radius, unlike, other);
}

// Returns the cones of all normals that the disks know, for the nodes that searches step to.
std::vector<ConeQuad> cones_of(const DiskSurface& disks);

// Disks as queries read them, made once for each cloud, with the second planes close to them;
// README.md has the reasons.
struct DenoisedDisks {
  std::vector<Vec3f> feet, normals;      // one per disk
  std::vector<std::uint32_t> second_of;  // per disk: index into seconds, or kNoPoint
  std::vector<float> radii;              // sampling radius per disk, m
  std::vector<SecondPlane> seconds;
};

class DiskWindows;

// Return the denoised disks, and the measured points themselves as disks. The result does not
// depend on the number of threads.
DenoisedDisks denoised(const DiskWindows& measured);
DenoisedDisks as_measured(const DiskWindows& measured);

}  // namespace vpm
