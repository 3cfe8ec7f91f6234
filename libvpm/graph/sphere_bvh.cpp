#include "libvpm/graph/sphere_bvh.h"

#include <algorithm>
#include <numeric>

#include "libvpm/core/box.h"

namespace vpm {
namespace {

constexpr std::uint32_t kLeafSize = 4;

}  // namespace

SphereBvh::SphereBvh(std::span<const Sphere> spheres) : spheres_(spheres), order_(spheres.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.reserve(spheres.size());
  build(0, static_cast<std::uint32_t>(spheres.size()));
}

std::uint32_t SphereBvh::build(std::uint32_t begin, std::uint32_t end) {
  const std::uint32_t self = static_cast<std::uint32_t>(nodes_.size());
  Node node{spheres_[order_[begin]].center, spheres_[order_[begin]].center, begin, end, 0};
  Box centers;
  for (std::uint32_t k = begin; k < end; ++k) {
    const Sphere& s = spheres_[order_[k]];
    centers.add(s.center);
    node.low = {std::min(node.low.x, s.center.x - s.radius),
                std::min(node.low.y, s.center.y - s.radius),
                std::min(node.low.z, s.center.z - s.radius)};
    node.high = {std::max(node.high.x, s.center.x + s.radius),
                 std::max(node.high.y, s.center.y + s.radius),
                 std::max(node.high.z, s.center.z + s.radius)};
  }
  nodes_.push_back(node);
  if (end - begin <= kLeafSize) return self;

  const int axis = centers.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
    const double xa = coordinate(spheres_[a].center, axis),
                 xb = coordinate(spheres_[b].center, axis);
    return xa != xb ? xa < xb : a < b;
  });
  build(begin, middle);
  nodes_[self].right = build(middle, end);
  return self;
}

std::uint32_t SphereBvh::nearest_surface(Vec3 x, std::uint32_t start) const {
  std::uint32_t best = start;
  double distance = surface_distance(x, spheres_[start]);
  walk(
      x, [&](std::uint32_t, double bound) { return bound <= distance; },
      [&](std::uint32_t i) {
        const double d = surface_distance(x, spheres_[i]);
        if (d < distance || (d == distance && i < best)) {
          distance = d;
          best = i;
        }
      });
  return best;
}

}  // namespace vpm
