// Stores points in a bounding volume hierarchy of axis-aligned boxes, which finds the nearest to a
// place and those in a ball. For host and device.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/scene/body.h"

namespace vpm {

// Describes an axis-aligned box; an empty one (padding) has low > high.
struct PointBox {
  Vec3f low, high;

  VPM_HD static double axis_gap(double x, double low, double high) {
    return x < low ? low - x : (x > high ? x - high : 0);
  }
  VPM_HD double squared_distance(Vec3 x) const {
    const double dx = axis_gap(x.x, low.x, high.x), dy = axis_gap(x.y, low.y, high.y),
                 dz = axis_gap(x.z, low.z, high.z);
    return dx * dx + dy * dy + dz * dz;
  }
};

// Holds four boxes in vector layout. Empty ones span infinity to -infinity: infinitely far.
struct alignas(16) BoxQuad {
  float low[3][4], high[3][4];

  VPM_HD PointBox box(std::uint32_t k) const {
    return {{low[0][k], low[1][k], low[2][k]}, {high[0][k], high[1][k], high[2][k]}};
  }
  void set(std::uint32_t k, const PointBox& box);
};

// Stacks nodes left to search. Pushes have no branches that depend on distances, which no CPU
// predicts.
class NodeStack {
 public:
  // Room for a tree of 2^22 leaves: three nodes of each quad on the way down, and one more.
  static constexpr int kRoom = 3 * 11 + 1;

  // Returns the largest key of a node that may hold a point within the squared distance, m^2.
  VPM_HD static std::uint64_t last_key(double squared) {
    return (squared < HUGE_VAL ? key_of(squared, 0) : key_of(HUGE_VAL, 0) - 1) | kWhich;
  }

  VPM_HD bool is_empty() const { return size_ == 0; }
  VPM_HD std::uint64_t top_key() const { return keys_[size_ - 1]; }
  VPM_HD std::uint32_t take() { return nodes_[--size_]; }
  VPM_HD void push_root() {
    keys_[0] = 0;
    nodes_[size_++] = 1;
  }
  // Pushes those of four nodes that are near enough, the nearest last; node_of(k), k in 0 to 3.
  template <class NodeOf>
  VPM_HD void push(const NodeOf& node_of, const double (&squared)[4], std::uint64_t last) {
    std::uint64_t key[4];
    for (std::uint32_t k = 0; k < 4; ++k) key[k] = key_of(squared[k], k);
    order(key[0], key[1]), order(key[2], key[3]);
    order(key[0], key[2]), order(key[1], key[3]);
    order(key[1], key[2]);
    for (const std::uint64_t k : key) {
      keys_[size_] = k;
      nodes_[size_] = node_of(static_cast<std::uint32_t>(k & kWhich));
      size_ += k <= last ? 1 : 0;
    }
  }

 private:
  static constexpr std::uint64_t kWhich = 3;

  // Returns a squared distance as an integer that orders like it, rounded down, with the index of
  // the node in its last two bits.
  VPM_HD static std::uint64_t key_of(double squared, std::uint64_t which) {
    std::uint64_t bits;
    std::memcpy(&bits, &squared, sizeof bits);
    return (bits & ~kWhich) | which;
  }

  VPM_HD static void order(std::uint64_t& greater, std::uint64_t& less) {
    const std::uint64_t all = std::uint64_t{0} - static_cast<std::uint64_t>(greater < less);
    const std::uint64_t swapped = (greater ^ less) & all;
    greater ^= swapped, less ^= swapped;
  }

  std::uint64_t keys_[kRoom + 1];
  std::uint32_t nodes_[kRoom + 1];
  int size_ = 0;
};

// Points to a number for each point, such as the radius of a ball about it, and to the largest of
// them in each node of the points' tree.
struct PointNumbers {
  const float* of_points = nullptr;
  const float* of_nodes = nullptr;
};

// Holds nodes of a tree that hold all points near a place, where searches begin to skip the rest.
// Host only.
struct TreeEntry {
  BoxQuad boxes;
  std::uint32_t nodes[4] = {};  // ascending; unused ones have empty boxes
  Vec3 center;
  double squared_reach = -1;         // places may be this far from the centre, m^2; negative: none
  double ball = 0;                   // radius about each such place in which all points are held, m
  std::uint32_t nearest = kNoPoint;  // to the centre

  bool holds(Vec3 x, double radius) const {
    return squared_norm(x - center) <= squared_reach && radius <= ball;
  }
};

// Holds plain pointers to a complete tree, for host or device: node k has the children 2k and 2k+1,
// the root is node 1, and leaf i holds the points [i * kLeafSize, (i + 1) * kLeafSize). A step goes
// down two levels, from the root or from its children, so that it ends at a leaf.
struct PointTree {
  static constexpr std::uint32_t kLeafSize = 8;
  static constexpr std::uint32_t kMostLeaves = std::uint32_t{1} << 22;
  // Bits of numbers of leaves that whole steps reach from the root.
  static constexpr std::uint32_t kEvenLevels = 0x55555555U;

  const Vec3f* points = nullptr;
  const BoxQuad* boxes = nullptr;  // node k is box k % 4 of quad k / 4
  std::uint32_t count = 0;
  std::uint32_t leaves = 0;  // a power of two
  TreeEntry entry{};

  // Lets searches at places within `reach`, m, of a centre begin near it.
  void enter_near(Vec3 center, double reach);

  // Holds the best point so far; kNoPoint where none was within the bound.
  struct Nearest {
    double squared = HUGE_VAL;
    std::uint32_t point = kNoPoint;

    VPM_HD void consider(double distance, std::uint32_t i) {
      if (!(distance < squared || (distance == squared && point != kNoPoint && i < point))) return;
      squared = distance;
      point = i;
    }
  };

  // Computes squared distances of four boxes, and of up to four points.
  struct OneByOne {
    VPM_HD static void to_boxes(const BoxQuad& quad, Vec3 x, double (&squared)[4]) {
      for (std::uint32_t k = 0; k < 4; ++k) squared[k] = quad.box(k).squared_distance(x);
    }
    VPM_HD static void to_points(const Vec3f* points, std::uint32_t count, Vec3 x,
                                 double (&squared)[4]) {
      for (std::uint32_t k = 0; k < 4 && k < count; ++k)
        squared[k] = squared_norm(widen(points[k]) - x);
    }
  };
  struct ByVectors;  // vector version for the host

  VPM_HD std::uint32_t nodes() const { return 4 * quads(); }  // size of arrays per node
  VPM_HD std::uint32_t quads() const { return leaves > 1 ? leaves / 2 : 1; }
  VPM_HD PointBox leaf_of(std::uint32_t point) const { return box_of(leaves + point / kLeafSize); }
  VPM_HD PointBox box_of(std::uint32_t node) const { return boxes[node / 4].box(node % 4); }
  VPM_HD std::uint32_t end_of_leaf(std::uint32_t begin) const {
    return begin + kLeafSize < count ? begin + kLeafSize : count;
  }

  // Returns the point nearest to x among those closer than `bound`, m, or kNoPoint; ties go to the
  // smaller index. A point `near` shortens the search and does not change its result.
  VPM_HD std::uint32_t nearest(Vec3 x, double bound, std::uint32_t near = kNoPoint) const {
    if (count == 0) return kNoPoint;
    Nearest best{bound * bound};
    if (near != kNoPoint) best.consider(squared_norm(widen(points[near]) - x), near);
#ifdef __CUDA_ARCH__
    search<OneByOne>(x, EachPoint{}, best);
#else
    search_by_vectors(x, best);
#endif
    return best.point;
  }

  // Returns in `found` what nearest() does for four places, without a bound, by one search. It is
  // the faster the nearer these are to each other. Requires a point. Host only.
  void nearest_of_four(const Vec3 (&places)[4], std::uint32_t near,
                       std::uint32_t (&found)[4]) const;

  // Returns the point nearest to x among those whose balls touch a ball about x, or kNoPoint.
  VPM_HD std::uint32_t nearest_touching(Vec3 x, double radius, const PointNumbers& radii) const {
    if (count == 0) return kNoPoint;
    Nearest best;
    const TouchingBall touching{radius, radii};
#ifdef __CUDA_ARCH__
    search<OneByOne>(x, touching, best);
#else
    search_by_vectors(x, touching, best);
#endif
    return best.point;
  }

  // Returns the point nearest to x among those with a mark above 0, or kNoPoint. Host only.
  std::uint32_t nearest_marked(Vec3 x, const PointNumbers& marks) const {
    if (count == 0) return kNoPoint;
    Nearest best;
    search<OneByOne>(x, Marked{marks}, best);
    return best.point;
  }

  // Calls visit(begin, end) for the points of each leaf that a ball touches, until it returns
  // false. Returns the last value.
  template <class Visit>
  VPM_HD bool for_leaves_in_ball(Vec3 center, double squared_radius, const Visit& visit) const {
    return for_leaves_in_ball<OneByOne>(center, squared_radius, EachNode{}, visit);
  }
  // Calls visit(begin, end) likewise for leaves in nodes for which enters(node) is true.
  // `Distances` is OneByOne or ByVectors (point_tree.cpp).
  template <class Distances, class Enters, class Visit>
  VPM_HD bool for_leaves_in_ball(Vec3 center, double squared_radius, const Enters& enters,
                                 const Visit& visit) const {
    if (count == 0) return true;
    std::uint32_t stack[NodeStack::kRoom + 1];
    int size = 0;
    double squared[4];
    const auto push = [&](const BoxQuad& quad, const auto& node_of, std::uint32_t first) {
      Distances::to_boxes(quad, center, squared);
      for (std::uint32_t k = 4; k-- > first;) {
        const std::uint32_t node = node_of(k);
        stack[size] = node;
        size += squared[k] <= squared_radius && enters(node) ? 1 : 0;
      }
    };
    const auto push_children = [&](std::uint32_t node, std::uint32_t first) {
      push(
          boxes[node], [&](std::uint32_t k) { return 4 * node + k; }, first);
    };
#ifndef __CUDA_ARCH__
    const bool enters_near = squared_radius <= entry.ball * entry.ball && entry.holds(center, 0);
#else
    constexpr bool enters_near = false;
#endif
    if (enters_near)
      push(
          entry.boxes, [&](std::uint32_t k) { return entry.nodes[k]; }, 0);
    else if (begins_at_root())
      stack[size++] = 1;
    else
      push_children(0, 2);
    while (size > 0) {
      const std::uint32_t node = stack[--size];
      if (node < leaves) {
        push_children(node, 0);
        continue;
      }
      const std::uint32_t begin = (node - leaves) * kLeafSize;
      if (!visit(begin, end_of_leaf(begin))) return false;
    }
    return true;
  }
  // Fill `quads` with the numbers of those quads that hold a leaf which a ball touches; append to
  // `listed` the leaves that one touches, of those in quads; and list the points in one, of those
  // in leaves, and return their number. All are in order. Host only.
  void list_quads(Vec3 center, double squared_radius, std::vector<std::uint32_t>& quads) const;
  void list_leaves(Vec3 center, double squared_radius, std::span<const std::uint32_t> quads,
                   std::vector<std::uint32_t>& listed) const;
  std::uint32_t list_points(std::span<const std::uint32_t> in_leaves, Vec3 center,
                            double squared_radius, std::uint32_t* listed) const;

  // Calls visit(i) for the points in a ball, until it returns false. Returns the last value.
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
  struct EachNode {
    VPM_HD bool operator()(std::uint32_t) const { return true; }
  };

  // Filters of a search, asked for nodes and points with their squared distances. within() returns
  // a distance within which the best point surely lies, m; 0 if that is the nearest of all.
  struct EachPoint {
    static double within(const PointTree&) { return 0; }
    VPM_HD bool takes_node(std::uint32_t, double) const { return true; }
    VPM_HD bool takes_point(std::uint32_t, double) const { return true; }
  };
  struct Marked {
    PointNumbers marks;

    static double within(const PointTree&) { return HUGE_VAL; }  // the nearest may be anywhere
    bool takes_node(std::uint32_t node, double) const { return marks.of_nodes[node] > 0; }
    bool takes_point(std::uint32_t i, double) const { return marks.of_points[i] > 0; }
  };
  struct TouchingBall {
    double radius;
    PointNumbers radii;

    double within(const PointTree& tree) const {
      const float* const of_nodes = radii.of_nodes;
      return radius +
             double{tree.begins_at_root() ? of_nodes[1] : std::max(of_nodes[2], of_nodes[3])};
    }
    VPM_HD bool takes_node(std::uint32_t node, double squared) const {
      return touches(radii.of_nodes[node], squared);
    }
    VPM_HD bool takes_point(std::uint32_t i, double squared) const {
      return touches(radii.of_points[i], squared);
    }
    VPM_HD bool touches(float other, double squared) const {
      const double reach = radius + other;
      return squared <= reach * reach;
    }
  };

  VPM_HD bool begins_at_root() const {
    return (leaves & kEvenLevels) != 0;
  }

  template <class Distances, class Takes>
  VPM_HD void search(Vec3 x, const Takes& takes, Nearest& best) const {
    NodeStack waiting;
    begin_search<Distances>(x, takes, best, waiting);
    while (!waiting.is_empty()) {
      const std::uint64_t key = waiting.top_key(), last = NodeStack::last_key(best.squared);
      const std::uint32_t node = waiting.take();
      // A node at exactly the best distance may hold an equal point of smaller index.
      if (key > last) continue;
      double squared[4];
      if (node < leaves) {
        Distances::to_boxes(boxes[node], x, squared);
        push_taken([&](std::uint32_t k) { return 4 * node + k; }, squared, takes, last, waiting);
        continue;
      }
      const std::uint32_t begin = (node - leaves) * kLeafSize, end = end_of_leaf(begin);
      for (std::uint32_t first = begin; first < end; first += 4) {
        Distances::to_points(points + first, end - first, x, squared);
        for (std::uint32_t k = 0; k < 4 && first + k < end; ++k) {
          if (takes.takes_point(first + k, squared[k])) best.consider(squared[k], first + k);
        }
      }
    }
  }
  template <class Distances, class Takes>
  VPM_HD void begin_search(Vec3 x, const Takes& takes, const Nearest& best,
                           NodeStack& waiting) const {
    begin_search<Distances>(x, takes, NodeStack::last_key(best.squared), waiting);
  }
  template <class Distances, class Takes>
  VPM_HD void begin_search(Vec3 x, const Takes& takes, std::uint64_t last,
                           NodeStack& waiting) const {
    double squared[4];
#ifndef __CUDA_ARCH__
    if (entry.holds(x, takes.within(*this))) {
      Distances::to_boxes(entry.boxes, x, squared);
      push_taken([&](std::uint32_t k) { return entry.nodes[k]; }, squared, takes, last, waiting);
      return;
    }
#endif
    if (begins_at_root()) {
      waiting.push_root();
      return;
    }
    Distances::to_boxes(boxes[0], x, squared);
    squared[0] = squared[1] = HUGE_VAL;
    waiting.push([](std::uint32_t k) { return k; }, squared, last);
  }
  template <class NodeOf, class Takes>
  VPM_HD static void push_taken(const NodeOf& node_of, double (&squared)[4], const Takes& takes,
                                std::uint64_t last, NodeStack& waiting) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (!takes.takes_node(node_of(k), squared[k])) squared[k] = HUGE_VAL;
    }
    waiting.push(node_of, squared, last);
  }
  void search_by_vectors(Vec3 x, Nearest& best) const;
  void search_by_vectors(Vec3 x, const TouchingBall& touching, Nearest& best) const;

  // Lists the points in a ball in order. Returns their number, or more than kMostListed.
  static constexpr std::uint32_t kMostListed = 512;
  std::uint32_t list_by_vectors(Vec3 center, double squared_radius,
                                std::uint32_t (&listed)[kMostListed]) const;
  // Lists the points [begin, end) of a leaf that are in a ball, in order. Returns their number.
  std::uint32_t list_in_leaf(std::uint32_t begin, std::uint32_t end, Vec3 center,
                             double squared_radius, std::uint32_t* listed) const;
};

// Returns the number of leaves for this many points; kMostLeaves can be searched.
std::uint32_t leaves_for(std::size_t points);

// Returns the boxes of a tree of points in the order of order_by_leaves().
std::vector<BoxQuad> boxes_of(std::span<const Vec3f> points);

// Returns PointNumbers::of_nodes for these radii.
std::vector<float> largest_in_nodes(std::span<const float> radii);

// Rearranges `order`, indices of points in a total order, for the leaves of a PointTree: each node
// is split across the longest side of its box so that its first half is full. Equal coordinates,
// and points in a leaf, keep the given order.
void order_by_leaves(std::span<const Vec3f> points, std::vector<std::uint32_t>& order);

// Lists a few points, which are faster to search than a tree. For host and device.
class PointList {
 public:
  static constexpr int kMost = 256;

  VPM_HD bool is_empty() const { return size_ == 0; }
  VPM_HD void clear() { size_ = 0; }
  // Adds a point; indices must ascend. Returns false if there is no room.
  VPM_HD bool add(std::uint32_t index, Vec3f place) {
    if (size_ == kMost) return false;
    places_[0][size_] = place.x, places_[1][size_] = place.y, places_[2][size_] = place.z;
    indices_[size_++] = index;
    return true;
  }

  // Returns the index of the point nearest to x; ties go to the smaller index. Requires a point.
  VPM_HD std::uint32_t nearest(Vec3 x) const {
#ifdef __CUDA_ARCH__
    return indices_[nearest_in_turn(x)];
#else
    return indices_[nearest_by_vectors(x)];
#endif
  }

 private:
  VPM_HD int nearest_in_turn(Vec3 x) const {
    double least = HUGE_VAL;
    int best = 0;
    for (int k = 0; k < size_; ++k) {
      const double squared =
          squared_norm(widen(Vec3f{places_[0][k], places_[1][k], places_[2][k]}) - x);
      if (!(squared < least)) continue;
      least = squared;
      best = k;
    }
    return best;
  }
  int nearest_by_vectors(Vec3 x) const;

  int size_ = 0;
  float places_[3][kMost];
  std::uint32_t indices_[kMost];
};

}  // namespace vpm
