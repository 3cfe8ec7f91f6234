#include "tools/bench/peers/sphere_pair.h"

#include <algorithm>

#include "libvpm/core/pose.h"

namespace vpm::bench {

double shared_by_balls(double radius_a, double radius_b, double apart) {
  const double less = std::min(radius_a, radius_b);
  if (apart >= radius_a + radius_b) return 0;
  if (apart <= std::abs(radius_a - radius_b)) return 4.0 / 3 * kPi * less * less * less;
  const double sum = radius_a + radius_b, difference = radius_a - radius_b;
  return kPi * (sum - apart) * (sum - apart) *
         (apart * apart + 2 * apart * sum - 3 * difference * difference) / (12 * apart);
}

SpherePairPeer::SpherePairPeer(const ToolModel& a, const ToolModel& b, std::uint32_t spheres)
    : a_{a, a.level(spheres).hierarchy}, b_{b, b.level(spheres).hierarchy}, spheres_(spheres) {}

std::size_t SpherePairPeer::bytes() const {
  std::size_t bytes = 2 * spheres_ * sizeof(Sphere);
  for (const Tree* tree : {&a_, &b_})
    bytes += tree->hierarchy.nodes.size() * sizeof(HierarchyNode) +
             tree->hierarchy.leaves.size() * sizeof(std::uint32_t);
  return bytes;
}

// Spheres are in b's frame.
void SpherePairPeer::add(const Sphere& a, const Sphere& b, Vec3 about, PeerAnswer& sum) const {
  const Vec3 apart = a.center - b.center;
  const double distance = norm(apart), volume = shared_by_balls(a.radius, b.radius, distance);
  if (!(volume > 0)) return;
  sum.volume += volume;
  ++sum.contacts;
  const Vec3 force = volume * normalized_or_zero(apart);
  // Of the interval that the balls share on the line of centres, measured from b's.
  const double low = std::max(distance - a.radius, -b.radius),
               high = std::min(distance + a.radius, b.radius);
  const Vec3 at = b.center + 0.5 * (low + high) * normalized_or_zero(apart);
  sum.wrench.force += force;
  sum.wrench.torque += cross(at - about, force);
}

PeerAnswer SpherePairPeer::query(const Pose& pose) {
  PeerAnswer sum{0, {}, 0};
  const Vec3 about = pose * a_.model.center_of_mass;
  const auto placed = [&](const Sphere& s) { return Sphere{pose * s.center, s.radius}; };
  open_.assign(1, {0, 0});
  while (!open_.empty()) {
    const auto [ia, ib] = open_.back();
    open_.pop_back();
    const HierarchyNode &na = a_.hierarchy.nodes[ia], &nb = b_.hierarchy.nodes[ib];
    const Sphere bound = placed(na.bound);
    const double reach = bound.radius + nb.bound.radius;
    if (squared_norm(bound.center - nb.bound.center) >= reach * reach) continue;
    const bool a_ends = na.children_are_leaves != 0, b_ends = nb.children_are_leaves != 0;
    if (a_ends && b_ends) {
      for (std::uint32_t i = na.begin; i < na.end; ++i) {
        const Sphere a = placed(a_.model.spheres[a_.hierarchy.leaves[i]]);
        for (std::uint32_t j = nb.begin; j < nb.end; ++j)
          add(a, b_.model.spheres[b_.hierarchy.leaves[j]], about, sum);
      }
    } else if (b_ends || (!a_ends && bound.radius >= nb.bound.radius)) {
      for (std::uint32_t child = na.begin; child < na.end; ++child) open_.emplace_back(child, ib);
    } else {
      for (std::uint32_t child = nb.begin; child < nb.end; ++child) open_.emplace_back(ia, child);
    }
  }
  return sum;
}

}  // namespace vpm::bench
