// Points in a bounding volume hierarchy of axis-aligned boxes: the nearest to a place, and those in
// a ball. For host and device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/query/surface.h"

namespace vpm {

// Axis-aligned; an empty one (padding) has low > high.
struct PointBox {
  Vec3f low, high;

  VPM_HD static double axis_gap(double x, double low, double high) {
    return x < low ? low - x : (x > high ? x - high : 0);
  }
  VPM_HD double squared_distance(Vec3 x) const {
    if (low.x > high.x) return HUGE_VAL;
    const double dx = axis_gap(x.x, low.x, high.x), dy = axis_gap(x.y, low.y, high.y),
                 dz = axis_gap(x.z, low.z, high.z);
    return dx * dx + dy * dy + dz * dz;
  }
};

// Four boxes by their coordinates, as vectors read them.
struct BoxQuad {
  float low[3][4], high[3][4];

  VPM_HD PointBox box(std::uint32_t k) const {
    return {{low[0][k], low[1][k], low[2][k]}, {high[0][k], high[1][k], high[2][k]}};
  }
  void set(std::uint32_t k, const PointBox& box);
};

// A view: plain pointers, for host or device. The tree is complete: node k has the children 2k and
// 2k+1, the root is node 1, and leaf i holds the points [i * kLeafSize, (i + 1) * kLeafSize).
struct PointTree {
  static constexpr std::uint32_t kLeafSize = 8;
  static constexpr int kMaxDepth = 32;

  const Vec3f* points = nullptr;
  const BoxQuad* boxes = nullptr;  // of node k: k % 4 of quad k / 4
  std::uint32_t count = 0;
  std::uint32_t leaves = 0;  // a power of two

  VPM_HD std::uint32_t quads() const { return leaves > 1 ? leaves / 2 : 1; }
  VPM_HD PointBox box(std::uint32_t node) const { return boxes[node / 4].box(node % 4); }
  VPM_HD PointBox leaf_of(std::uint32_t point) const { return box(leaves + point / kLeafSize); }
  VPM_HD std::uint32_t end_of_leaf(std::uint32_t begin) const {
    return begin + kLeafSize < count ? begin + kLeafSize : count;
  }

  // The point nearest to x among those closer than `bound`; equal distances go to the smaller
  // index. kNoPoint if none. A point that is thought to be near makes the search short and does not
  // change its result.
  VPM_HD std::uint32_t nearest(Vec3 x, double bound, std::uint32_t near = kNoPoint) const {
    if (count == 0) return kNoPoint;
    Nearest best{bound * bound, kNoPoint};
    if (near != kNoPoint) {
      const double squared = squared_norm(widen(points[near]) - x);
      if (squared < best.squared) best = {squared, near};
    }
#ifdef __CUDA_ARCH__
    search(x, best);
#else
    search_by_vectors(x, best);  // finds the same
#endif
    return best.point;
  }

  // Calls visit(begin, end) for the leaves that a ball touches, by their points, until it says
  // false, and returns what it said last.
  template <class Visit>
  VPM_HD bool for_leaves_in_ball(Vec3 center, double squared_radius, const Visit& visit) const {
    if (count == 0) return true;
    std::uint32_t stack[kMaxDepth];
    int size = 0;
    stack[size++] = 1;
    while (size > 0) {
      const std::uint32_t node = stack[--size];
      if (box(node).squared_distance(center) > squared_radius) continue;
      if (node < leaves) {
        stack[size++] = 2 * node + 1;
        stack[size++] = 2 * node;
        continue;
      }
      const std::uint32_t begin = (node - leaves) * kLeafSize;
      if (!visit(begin, end_of_leaf(begin))) return false;
    }
    return true;
  }
  // The same for the points in a ball.
  template <class Visit>
  VPM_HD bool for_points_in_ball(Vec3 center, double squared_radius, const Visit& visit) const {
#ifndef __CUDA_ARCH__
    std::uint32_t listed[kMostListed];
    const std::uint32_t size = list_by_vectors(center, squared_radius, listed);
    if (size <= kMostListed) {
      for (std::uint32_t k = 0; k < size; ++k) {
        if (!visit(listed[k])) return false;
      }
      return true;
    }
#endif
    return for_leaves_in_ball(center, squared_radius, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = begin; i < end; ++i) {
        if (squared_norm(widen(points[i]) - center) <= squared_radius && !visit(i)) return false;
      }
      return true;
    });
  }

 private:
  // The best of those that were searched; kNoPoint where none was as near as the bound.
  struct Nearest {
    double squared;
    std::uint32_t point;

    VPM_HD void consider(double distance, std::uint32_t i) {
      if (!(distance < squared || (distance == squared && point != kNoPoint && i < point))) return;
      squared = distance;
      point = i;
    }
  };
  // A node at exactly the best distance may hold an equal point of smaller index: it is entered.
  VPM_HD void search(Vec3 x, Nearest& best) const {
    std::uint32_t stack[kMaxDepth];
    double stack_squared[kMaxDepth];
    int size = 0;
    std::uint32_t node = 1;
    double node_squared = box(1).squared_distance(x);
    for (;;) {
      if (node_squared <= best.squared) {
        if (node < leaves) {
          const std::uint32_t left = 2 * node;
          const double dl = box(left).squared_distance(x), dr = box(left + 1).squared_distance(x);
          const bool left_first = dl <= dr;
          stack[size] = left_first ? left + 1 : left;
          stack_squared[size++] = left_first ? dr : dl;
          node = left_first ? left : left + 1;
          node_squared = left_first ? dl : dr;
          continue;
        }
        const std::uint32_t begin = (node - leaves) * kLeafSize, end = end_of_leaf(begin);
        for (std::uint32_t i = begin; i < end; ++i)
          best.consider(squared_norm(widen(points[i]) - x), i);
      }
      if (size == 0) return;
      node = stack[--size];
      node_squared = stack_squared[size];
    }
  }
  // The same on the host.
  void search_by_vectors(Vec3 x, Nearest& best) const;

  // The points in a ball, in their order; returns how many, or more than kMostListed.
  static constexpr std::uint32_t kMostListed = 512;
  std::uint32_t list_by_vectors(Vec3 center, double squared_radius,
                                std::uint32_t (&listed)[kMostListed]) const;
};

// How many leaves a tree of so many points has.
std::uint32_t leaves_for(std::size_t points);

// The boxes of a tree of points in the order of order_by_leaves (leaf_order.h).
std::vector<BoxQuad> boxes_of(std::span<const Vec3f> points);

}  // namespace vpm
