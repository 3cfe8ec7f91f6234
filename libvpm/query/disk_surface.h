// A surface as an unorganised cloud holds it: disks (point, normal, sampling radius) in a bounding
// volume hierarchy.
//
// The nearest point decides on which side a place lies. Points are in the cloud's frame about its
// origin.
#pragma once

#include "libvpm/query/pixel_rectangle.h"
#include "libvpm/query/surface.h"

namespace vpm {

// Axis-aligned box of the points below a node; empty boxes (padding) have low > high.
struct PointBox {
  Vec3f low, high;
};

// A view: plain pointers, for host or device. The tree is complete: node k has the children 2k and
// 2k+1, the root is node 1, and leaf i holds the points [i * kLeafSize, (i + 1) * kLeafSize) in
// canonical order.
struct DiskSurface {
  static constexpr std::uint32_t kLeafSize = 8;
  static constexpr int kMaxDepth = 32;

  const Vec3f* positions = nullptr;
  const Vec3f* normals = nullptr;
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
      const double squared = squared_norm(widen(positions[near]) - x);
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
          const double squared = squared_norm(widen(positions[i]) - x);
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
    const Vec3 normal = widen(normals[i]), foot = widen(positions[i]);
    return {true, dot(normal, x - foot), normal, foot, i};
  }

  // The surface for places in a ball: the few points that may be nearest to one of them, if they
  // are few. `nearest`: the point nearest to the centre.
  class AroundBall;
  VPM_HD AroundBall around_ball(Vec3 center, double radius, std::uint32_t nearest) const;

  // Gradient of the distance to the nearest disk at a place x behind it: the normal above the disk,
  // towards the rim beside it (at a crease, where the gradient fans out).
  VPM_HD Vec3 closest_normal(Vec3 x, const Reading& reading) const {
    const Vec3 towards = reading.foot - x;
    const double height = dot(reading.normal, towards);
    const Vec3 aside = towards - height * reading.normal;
    const double aside_squared = squared_norm(aside);
    if (height > 0 && aside_squared <= largest_radius * largest_radius) return reading.normal;
    return normalized_or_zero(towards - (largest_radius / std::sqrt(aside_squared)) * aside);
  }

  // Each disk is a plane of its own: nothing is taken for flat, and no bound of the gap is known.
  struct Look {
    Side side = Side::free;
    std::uint32_t point = kNoPoint;  // the nearest to the centre, where the ball may touch it
  };
  VPM_HD Look look_at_ball(Vec3 center, double radius) const {
    const std::uint32_t point = nearest(center, radius + largest_radius);
    return {point == kNoPoint ? Side::uncut : Side::mixed, point};
  }
  VPM_HD Side side_of_ball(Vec3 center, double radius) const {
    return look_at_ball(center, radius).side;
  }
  VPM_HD Side side_of(const Look& look, Vec3, double) const { return look.side; }
  static VPM_HD PixelRectangle pixels_of(const Look&) { return {}; }
  VPM_HD bool is_seen_past(const PixelRectangle&, double, std::uint32_t, std::uint32_t) const {
    return false;
  }
  VPM_HD bool is_flat(const Look&, Vec3, double, TangentPlane&) const { return false; }
  VPM_HD bool may_be_flat(const Look&) const { return false; }
  VPM_HD bool is_flat(const Look&, const Reading&, double, TangentPlane&) const { return false; }
  VPM_HD bool may_be_free(const Look&, Vec3, double) const { return true; }
  VPM_HD bool may_be_free(Vec3, double) const { return true; }
  VPM_HD bool may_hold_free(const Look&, Vec3, double) const { return true; }
  VPM_HD bool tells_of_parts(Vec3, double) const { return false; }
  VPM_HD bool is_free_part(const Look&, Vec3, double) const { return false; }
  VPM_HD bool may_touch(const Look&, Vec3, double) const { return true; }
  template <class ReadAll>
  VPM_HD bool mean_plane(const Look&, Vec3, double, double, const ReadAll&, TangentPlane&) const {
    return false;
  }
  VPM_HD double largest_gap(const Look&, Vec3, double) const { return HUGE_VAL; }
};

// Sparse points: a tool's piece is far from most of them, and a list of a dozen is quicker to
// search than the tree. Answers have the same bits.
class DiskSurface::AroundBall {
 public:
  VPM_HD AroundBall(const DiskSurface& surface, Vec3 center, double radius, std::uint32_t nearest)
      : surface_(surface), center_(center) {
    if (nearest == kNoPoint) return;
    const double covered = kSlack * radius;
    const double distance = norm(widen(surface.positions[nearest]) - center);
    if (are_many(nearest, covered * (distance + covered))) return;
    squared_radius_ = covered * covered;
    const double reach = kSlack * (distance + 2 * covered);
    gather(reach * reach);
  }

  VPM_HD Reading read(Vec3 x, std::uint32_t near) const {
    if (count_ == 0 || !(squared_norm(x - center_) <= squared_radius_))
      return surface_.read(x, near);
    std::uint32_t best = points_[0];
    double best_squared = squared_norm(widen(surface_.positions[best]) - x);
    for (int k = 1; k < count_; ++k) {
      const double squared = squared_norm(widen(surface_.positions[points_[k]]) - x);
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
    std::uint32_t stack[kMaxDepth];
    int size = 0;
    stack[size++] = 1;
    while (size > 0) {
      const std::uint32_t node = stack[--size];
      if (squared_distance(surface_.nodes[node], center_) > squared_reach) continue;
      if (node < surface_.leaves) {
        stack[size++] = 2 * node + 1;
        stack[size++] = 2 * node;
        continue;
      }
      const std::uint32_t begin = (node - surface_.leaves) * kLeafSize;
      for (std::uint32_t i = begin; i < begin + kLeafSize && i < surface_.count; ++i) {
        if (squared_norm(widen(surface_.positions[i]) - center_) > squared_reach) continue;
        if (count_ == kMostPoints) {
          count_ = 0;
          return;
        }
        points_[count_++] = i;
      }
    }
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
