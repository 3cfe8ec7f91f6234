// A surface as an unorganised cloud holds it: disks (point, normal, sampling radius) in a bounding
// volume hierarchy.
//
// The nearest disk decides on which side a place lies. Places are in the cloud's frame about its
// origin.
#pragma once

#include "libvpm/query/ball_fraction.h"
#include "libvpm/query/pixel_rectangle.h"
#include "libvpm/query/surface.h"

namespace vpm {

// Axis-aligned box of the feet below a node, and of the points that they were measured at; empty
// boxes (padding) have low > high.
struct PointBox {
  Vec3f low, high;
};

// A second plane at a disk: the solid lies behind both (a convex edge, a thin plate), or behind
// either of them (a concave one, a slot).
struct SecondPlane {
  Vec3f normal, foot;
  bool is_convex = false;

  VPM_HD TangentPlane plane() const { return {widen(normal), widen(foot)}; }
};

// A view: plain pointers, for host or device. The tree is complete: node k has the children 2k and
// 2k+1, the root is node 1, and leaf i holds the points [i * kLeafSize, (i + 1) * kLeafSize) in
// canonical order.
struct DiskSurface {
  static constexpr std::uint32_t kLeafSize = 8;
  static constexpr int kMaxDepth = 32;

  const Vec3f* feet = nullptr;
  const Vec3f* normals = nullptr;
  const std::uint32_t* second_of = nullptr;  // of each disk: index into seconds, or kNoPoint
  const SecondPlane* seconds = nullptr;
  const PointBox* nodes = nullptr;
  std::uint32_t count = 0;
  std::uint32_t leaves = 0;   // a power of two
  double largest_radius = 0;  // of any disk

  VPM_HD static double axis_gap(double x, double low, double high) {
    return x < low ? low - x : (x > high ? x - high : 0);
  }
  VPM_HD static double squared_distance(const PointBox& box, Vec3 x) {
    if (box.low.x > box.high.x) return HUGE_VAL;
    const double dx = axis_gap(x.x, box.low.x, box.high.x),
                 dy = axis_gap(x.y, box.low.y, box.high.y),
                 dz = axis_gap(x.z, box.low.z, box.high.z);
    return dx * dx + dy * dy + dz * dz;
  }

  // The point nearest to x among those closer than `bound`; equal distances go to the smaller
  // index. kNoPoint if none. A point that is thought to be near makes the search short and does not
  // change its result.
  VPM_HD std::uint32_t nearest(Vec3 x, double bound, std::uint32_t near = kNoPoint) const {
    if (count == 0) return kNoPoint;
    std::uint32_t best = kNoPoint;
    double best_squared = bound * bound;
    if (near != kNoPoint) {
      const double squared = squared_norm(widen(feet[near]) - x);
      if (squared < best_squared) {
        best_squared = squared;
        best = near;
      }
    }
    std::uint32_t stack[kMaxDepth];
    double stack_squared[kMaxDepth];
    int size = 0;
    std::uint32_t node = 1;
    double node_squared = squared_distance(nodes[1], x);
    for (;;) {
      // A node at exactly the best distance may hold an equal point of smaller index: it is
      // entered.
      if (node_squared <= best_squared) {
        if (node < leaves) {
          const std::uint32_t left = 2 * node;
          const double dl = squared_distance(nodes[left], x),
                       dr = squared_distance(nodes[left + 1], x);
          const bool left_first = dl <= dr;
          stack[size] = left_first ? left + 1 : left;
          stack_squared[size++] = left_first ? dr : dl;
          node = left_first ? left : left + 1;
          node_squared = left_first ? dl : dr;
          continue;
        }
        const std::uint32_t begin = (node - leaves) * kLeafSize;
        const std::uint32_t end = begin + kLeafSize < count ? begin + kLeafSize : count;
        for (std::uint32_t i = begin; i < end; ++i) {
          const double squared = squared_norm(widen(feet[i]) - x);
          if (squared < best_squared || (squared == best_squared && best != kNoPoint && i < best)) {
            best_squared = squared;
            best = i;
          }
        }
      }
      if (size == 0) return best;
      node = stack[--size];
      node_squared = stack_squared[size];
    }
  }

  // The disk of the nearest point, taken for the surface around x. Unknown only in an empty cloud.
  VPM_HD Reading read(Vec3 x, std::uint32_t near = kNoPoint) const {
    return read_point(x, nearest(x, HUGE_VAL, near));
  }
  VPM_HD Reading read_point(Vec3 x, std::uint32_t i) const {
    if (i == kNoPoint) return {};
    const TangentPlane own = plane_of(i);
    const double distance = own.distance(x);
    if (const SecondPlane* const second = second_at(i)) {
      const TangentPlane beyond = second->plane();
      const double other = beyond.distance(x);
      if (second->is_convex ? other > distance : other < distance)
        return {true, other, beyond.normal, beyond.foot, i};
    }
    return {true, distance, own.normal, own.foot, i};
  }

  // The part of a ball about x that is behind the surface that was read there.
  VPM_HD double fraction_inside(const Reading& reading, Vec3 x, double radius) const {
    const SecondPlane* const second = second_at(reading.point);
    if (second == nullptr) return ball_fraction_inside(reading.distance / radius);
    const TangentPlane own = plane_of(reading.point), beyond = second->plane();
    const double first_inside = ball_fraction_inside(own.distance(x) / radius);
    const double second_inside = ball_fraction_inside(beyond.distance(x) / radius);
    const double cosine = dot(own.normal, beyond.normal);
    return second->is_convex ? fraction_of_both(first_inside, second_inside, cosine)
                             : 1 - fraction_of_both(1 - first_inside, 1 - second_inside, cosine);
  }

  // Calls visit(begin, end) for the leaves that a ball touches, by their points, until it says
  // false, and returns what it said last.
  template <class Visit>
  VPM_HD bool for_leaves_in_ball(Vec3 center, double squared_radius, const Visit& visit) const {
    std::uint32_t stack[kMaxDepth];
    int size = 0;
    stack[size++] = 1;
    while (size > 0) {
      const std::uint32_t node = stack[--size];
      if (squared_distance(nodes[node], center) > squared_radius) continue;
      if (node < leaves) {
        stack[size++] = 2 * node + 1;
        stack[size++] = 2 * node;
        continue;
      }
      const std::uint32_t begin = (node - leaves) * kLeafSize;
      if (!visit(begin, begin + kLeafSize < count ? begin + kLeafSize : count)) return false;
    }
    return true;
  }
  // The same for the points in a ball.
  template <class Visit>
  VPM_HD bool for_points_in_ball(Vec3 center, double squared_radius, const Visit& visit) const {
    return for_leaves_in_ball(center, squared_radius, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = begin; i < end; ++i) {
        if (squared_norm(widen(feet[i]) - center) <= squared_radius && !visit(i)) return false;
      }
      return true;
    });
  }

  // The surface for places in a ball: the few points that may be nearest to one of them, if they
  // are few. `nearest`: the point nearest to the centre.
  class AroundBall;
  VPM_HD AroundBall around_ball(Vec3 center, double radius, std::uint32_t nearest) const;

  // Gradient of the distance to the nearest disk at a place x behind it: the normal above the disk,
  // towards the rim beside it (at a crease, where the gradient fans out). Where the disk knows both
  // sides of a groove, towards these, or their crease.
  VPM_HD Vec3 closest_normal(Vec3 x, const Reading& reading) const {
    const SecondPlane* const second = second_at(reading.point);
    if (second != nullptr && !second->is_convex)
      return normal_below_groove(x, reading, second->plane());
    const Vec3 towards = reading.foot - x;
    const double height = dot(reading.normal, towards);
    const Vec3 aside = towards - height * reading.normal;
    const double aside_squared = squared_norm(aside);
    if (height > 0 && aside_squared <= largest_radius * largest_radius) return reading.normal;
    return normalized_or_zero(towards - (largest_radius / std::sqrt(aside_squared)) * aside);
  }

  // A body of this radius about x is nearest to `own`, by a point of it. Looks for another wall at
  // four places that are further behind, on each side: of those that face elsewhere (cosine less
  // than `unlike`) that which takes the most of the body.
  VPM_HD bool find_other_wall(Vec3 x, const TangentPlane& own, std::uint32_t point, double radius,
                              double unlike, OtherWall& other) const {
    const Vec3 side = normalized_or_zero(cross(own.normal, axis_aside(own.normal))),
               across = cross(own.normal, side);
    const Vec3 asides[4] = {side, -1.0 * side, across, -1.0 * across};
    double least = radius;
    for (const Vec3 aside : asides) {
      const Vec3 place = x + kFurther * radius * (aside - own.normal);
      if (own.distance(place) >= 0) continue;
      const Reading there = read(place, point);
      if (!(there.distance < 0)) continue;
      const Vec3 normal = closest_normal(place, there);
      if (dot(normal, own.normal) > unlike) continue;
      const Vec3 between = own.normal - normal;
      const double away = (own.distance(x) - dot(normal, x - there.foot)) / norm(between);
      if (!(away < least)) continue;
      least = away > 0 ? away : 0;
      other.normal = normal;
      other.border.normal = normalized_or_zero(between);
      other.border.foot = x - away * other.border.normal;
    }
    return least < radius;
  }

  // What a ball is to the disks. No bound of the gap is known.
  struct Look {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;  // the nearest to the centre, where the ball may touch it
    Vec3 center;
    double radius = 0;
  };
  VPM_HD Look look_at_ball(Vec3 center, double radius) const {
    const std::uint32_t point = nearest(center, radius + largest_radius);
    return {point == kNoPoint ? Side::uncut : Side::mixed, point, center, radius};
  }
  VPM_HD Side side_of_ball(Vec3 center, double radius) const {
    return look_at_ball(center, radius).side;
  }
  VPM_HD Side side_of(const Look& look, Vec3, double) const { return look.side; }
  static VPM_HD PixelRectangle pixels_of(const Look&) { return {}; }
  VPM_HD bool is_seen_past(const PixelRectangle&, double, std::uint32_t, std::uint32_t) const {
    return false;
  }
  VPM_HD bool may_be_flat(const Look& look) const { return look.point != kNoPoint; }
  VPM_HD bool is_flat(const Look& look, Vec3, double tolerance, TangentPlane& plane) const {
    return mean_plane(look, tolerance, plane);
  }
  VPM_HD bool is_flat(const Look& look, const Reading&, double tolerance,
                      TangentPlane& plane) const {
    return mean_plane(look, tolerance, plane);
  }
  // Points do not tell what is free.
  VPM_HD bool may_be_free(const Look&, Vec3, double) const { return false; }
  VPM_HD bool may_be_free(Vec3, double) const { return false; }
  VPM_HD bool may_hold_free(const Look&, Vec3, double) const { return false; }
  VPM_HD bool tells_of_parts(Vec3, double) const { return false; }
  VPM_HD bool is_free_part(const Look&, Vec3, double) const { return false; }
  VPM_HD bool may_touch(const Look&, Vec3, double) const { return true; }
  template <class ReadAll>
  VPM_HD bool mean_plane(const Look& look, Vec3, double, double tolerance, const ReadAll&,
                         TangentPlane& plane) const {
    return mean_plane(look, tolerance, plane);
  }
  // The mean plane of the disks below a ball that was looked at; false where they do not show one
  // smooth surface: one faces away from it or lies off it by more than a part of `tolerance`, or
  // those to one side of the middle are too few or face elsewhere.
  VPM_HD bool mean_plane(const Look& look, double tolerance, TangentPlane& plane) const {
    if (look.point == kNoPoint) return false;
    const Reading nearest = read_point(look.center, look.point);
    const double height = nearest.distance, near = kMiddle * look.radius;
    const Vec3 middle = look.center - height * nearest.normal;
    Vec3 normal_sum, place_sum;
    std::uint32_t found = 0;
    const bool few = for_points_in_ball(middle, near * near, [&](std::uint32_t i) {
      normal_sum += widen(normals[i]);
      place_sum += widen(feet[i]);
      return ++found <= kMostOfPatch;
    });
    if (!few || found == 0) return false;
    plane = {normalized_or_zero(normal_sum), 1.0 / found * place_sum};
    return shows(plane, middle, look.center, look.radius * look.radius + height * height,
                 kOffPlane * tolerance);
  }
  VPM_HD double largest_gap(const Look&, Vec3, double) const { return HUGE_VAL; }

 private:
  static constexpr std::uint32_t kMostOfPatch = 1024;  // points; more would take longer than shares
  static constexpr std::uint32_t kFewestAside = 3;     // points of a patch to one side
  static constexpr double kSmoothCosine = 0.9;         // as in an image
  // A paraboloid is as high in the mean over this part of a ball's disk as over a cube in it.
  static constexpr double kMiddle = 0.65;
  static constexpr double kOffPlane = 0.5;  // of the tolerance
  // Other walls are looked for so many radii aside, and as many further behind: at a body's end.
  static constexpr double kFurther = 0.85;
  static constexpr double kSlot = -0.8;  // cosine between the sides of a slot, at most

  // Of the solid behind either of two planes, for a place behind both: the normal of that which is
  // nearest where the other does not hide its foot, or the direction to where they meet.
  VPM_HD Vec3 normal_below_groove(Vec3 x, const Reading& reading, const TangentPlane& other) const {
    const TangentPlane own = plane_of(reading.point);
    const double a = own.distance(x), b = other.distance(x);
    const double cosine = dot(own.normal, other.normal);
    if (!(a < 0 && b < 0 && cosine > kSlot)) return reading.normal;
    const double along_own = b * cosine - a, along_other = a * cosine - b;
    if (along_own <= 0) return other.normal;
    if (along_other <= 0) return own.normal;
    return normalized_or_zero(along_own * own.normal + along_other * other.normal);
  }

  VPM_HD TangentPlane plane_of(std::uint32_t i) const {
    return {widen(normals[i]), widen(feet[i])};
  }
  // Null: the disk knows one plane only.
  VPM_HD const SecondPlane* second_at(std::uint32_t i) const {
    return second_of[i] == kNoPoint ? nullptr : seconds + second_of[i];
  }

  // A coordinate axis that is far from a direction.
  static VPM_HD Vec3 axis_aside(Vec3 n) {
    return std::fabs(n.x) < std::fabs(n.y) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  }

  // Whether the points in a ball show this plane, on all sides of a place of it.
  VPM_HD bool shows(const TangentPlane& plane, Vec3 middle, Vec3 center, double squared_radius,
                    double tolerance) const {
    const Vec3 n = plane.normal;
    const Vec3 side = cross(n, axis_aside(n)), other = cross(n, side);
    Vec3 sums[4];
    std::uint32_t counts[4] = {};
    std::uint32_t found = 0;
    const bool agree = for_points_in_ball(center, squared_radius, [&](std::uint32_t i) {
      const Vec3 place = widen(feet[i]), away = place - middle, normal = widen(normals[i]);
      const int aside = (dot(away, side) > 0 ? 1 : 0) + (dot(away, other) > 0 ? 2 : 0);
      sums[aside] += normal;
      ++counts[aside];
      return ++found <= kMostOfPatch && dot(normal, n) > 0 &&
             std::fabs(plane.distance(place)) <= tolerance;
    });
    for (int k = 0; agree && k < 4; ++k) {
      if (counts[k] < kFewestAside || dot(normalized_or_zero(sums[k]), n) < kSmoothCosine)
        return false;
    }
    return agree;
  }
};

// Sparse points: a tool's piece is far from most of them, and a list of a dozen is quicker to
// search than the tree. Answers have the same bits.
class DiskSurface::AroundBall {
 public:
  VPM_HD AroundBall(const DiskSurface& surface, Vec3 center, double radius, std::uint32_t nearest)
      : surface_(surface), center_(center) {
    if (nearest == kNoPoint) return;
    const double covered = kSlack * radius;
    const double distance = norm(widen(surface.feet[nearest]) - center);
    if (are_many(nearest, covered * (distance + covered))) return;
    squared_radius_ = covered * covered;
    const double reach = kSlack * (distance + 2 * covered);
    gather(reach * reach);
  }

  VPM_HD Reading read(Vec3 x, std::uint32_t near) const {
    if (count_ == 0 || !(squared_norm(x - center_) <= squared_radius_))
      return surface_.read(x, near);
    std::uint32_t best = points_[0];
    double best_squared = squared_norm(widen(surface_.feet[best]) - x);
    for (int k = 1; k < count_; ++k) {
      const double squared = squared_norm(widen(surface_.feet[points_[k]]) - x);
      if (squared < best_squared || (squared == best_squared && points_[k] < best)) {
        best_squared = squared;
        best = points_[k];
      }
    }
    return surface_.read_point(x, best);
  }

 private:
  static constexpr int kMostPoints = 48;
  static constexpr double kSlack = 1 + 1e-9;  // more than distances are rounded by

  // Those that may be nearest lie in a disk of the surface about the centre's foot; its squared
  // radius is 4 `quarter`. The nearest point's leaf tells how densely.
  VPM_HD bool are_many(std::uint32_t nearest, double quarter) const {
    const PointBox& leaf = surface_.nodes[surface_.leaves + nearest / kLeafSize];
    const double squared_diagonal = squared_norm(widen(leaf.high) - widen(leaf.low));
    const double area = 12 * quarter, area_of_leaf = 0.5 * squared_diagonal;  // roughly
    return area * kLeafSize > 2 * kMostPoints * area_of_leaf;
  }

  // The points that may be nearest; none if they are more than kMostPoints.
  VPM_HD void gather(double squared_reach) {
    const bool few = surface_.for_points_in_ball(center_, squared_reach, [&](std::uint32_t i) {
      if (count_ == kMostPoints) return false;
      points_[count_++] = i;
      return true;
    });
    if (!few) count_ = 0;
  }

  const DiskSurface& surface_;
  Vec3 center_;
  double squared_radius_ = 0;
  int count_ = 0;
  std::uint32_t points_[kMostPoints];
};

VPM_HD inline DiskSurface::AroundBall DiskSurface::around_ball(Vec3 center, double radius,
                                                               std::uint32_t nearest) const {
  return {*this, center, radius, nearest};
}

}  // namespace vpm
