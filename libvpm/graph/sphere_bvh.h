// Bounding volume hierarchy over the spheres of a packing, for searches by distance to their
// surfaces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/model/sphere.h"

namespace vpm {

// Bound on the rounding error of a lower bound, for coordinates of magnitude 1.
inline constexpr double kBvhSlack = 1e-12;

// Returns the signed distance of x from the surface, negative inside.
inline double surface_distance(Vec3 x, const Sphere& s) {
  return norm(x - s.center) - s.radius;
}

// Keeps a view of the spheres, which must outlive it. Coordinates must be of magnitude 1
// (kBvhSlack). Thread-safe once built.
class SphereBvh {
 public:
  struct Node {
    Vec3 low, high;                    // bounding box of the spheres below
    std::uint32_t begin = 0, end = 0;  // range of `order`
    // Second child; the first follows the node. 0 for a leaf.
    std::uint32_t right = 0;
  };

  explicit SphereBvh(std::span<const Sphere> spheres);

  std::span<const Sphere> spheres() const { return spheres_; }
  std::span<const Node> nodes() const { return nodes_; }           // root first, children follow
  std::span<const std::uint32_t> order() const { return order_; }  // sphere indices, by node

  // Returns the sphere with the smallest surface_distance(x), the lowest index on ties. `start` is
  // a guess that affects speed only.
  std::uint32_t nearest_surface(Vec3 x, std::uint32_t start) const;

  // Calls visit(sphere index) for the spheres of each leaf whose ancestors all pass enter(node
  // index, lower bound of the surface distance). Visits nearer children first.
  template <class Enter, class Visit>
  void walk(Vec3 x, Enter&& enter, Visit&& visit) const;

 private:
  std::uint32_t build(std::uint32_t begin, std::uint32_t end);
  static double box_distance(Vec3 x, const Node& node);

  std::span<const Sphere> spheres_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

inline double SphereBvh::box_distance(Vec3 x, const Node& node) {
  const auto outside = [](double value, double low, double high) {
    return value < low ? low - value : (value > high ? value - high : 0.0);
  };
  return norm({outside(x.x, node.low.x, node.high.x), outside(x.y, node.low.y, node.high.y),
               outside(x.z, node.low.z, node.high.z)});
}

template <class Enter, class Visit>
void SphereBvh::walk(Vec3 x, Enter&& enter, Visit&& visit) const {
  struct Pending {
    std::uint32_t node;
    double bound;
  };
  // Median splits halve the range, so 32-bit indices give a depth of 33 at most.
  std::array<Pending, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, box_distance(x, nodes_[0])};
  while (depth > 0) {
    const Pending top = stack[--depth];
    if (!enter(top.node, top.bound - kBvhSlack)) continue;
    const Node& node = nodes_[top.node];
    if (node.right == 0) {
      for (std::uint32_t k = node.begin; k < node.end; ++k) visit(order_[k]);
      continue;
    }
    const Pending left{top.node + 1, box_distance(x, nodes_[top.node + 1])};
    const Pending right{node.right, box_distance(x, nodes_[node.right])};
    const bool left_first = left.bound <= right.bound;
    stack[depth++] = left_first ? right : left;
    stack[depth++] = left_first ? left : right;
  }
}

}  // namespace vpm
