#include "libvpm/solid/sphere_pair.h"

#include <algorithm>
#include <tuple>

#include "libvpm/core/pose.h"
#include "libvpm/measure/sphere_contact.h"
#include "libvpm/solid/pair_order.h"

namespace vpm {
namespace {

// Orders the smaller one first, in whose units sums are: what is shared is a part of it.
auto key_of(const InnerSphereTree& t) {
  return std::tuple(t.model.volume, t.model.radius, t.model.solid_hash, t.level.sphere_count);
}

Sphere placed(const Pose& pose, const Sphere& s) {
  return {pose * s.center, s.radius};
}

// Sums over pairs of spheres in the first solid's units, about its centre of mass. Spheres of a
// packing do not overlap, nor what their pairs share, so the bounds of ToolSum hold.
struct PairSum {
  ToolSum sum;
  ToolSum::Sum moment[3];

  void add(const ToolMeasures& first, const SphereContact& contact) {
    const double part = contact.volume / first.volume;
    const Vec3 arm = (contact.centroid - first.center_of_mass) / first.radius;
    sum.add(part, contact.normal, arm);
    moment[0].add(part * arm.x), moment[1].add(part * arm.y), moment[2].add(part * arm.z);
  }

  // Returns the sums in the first's frame, with the torque about the centroid.
  SharedSolid result(const ToolMeasures& first) const {
    const auto real = [](const ToolSum::Sum(&v)[3]) {
      return Vec3{v[0].real(), v[1].real(), v[2].real()};
    };
    SharedSolid shared;
    const double part = sum.volume.real();
    if (!(part > 0)) return shared;
    const Vec3 arm = first.radius / part * real(moment);
    shared.volume = first.volume * part;
    shared.centroid = first.center_of_mass + arm;
    shared.force = first.volume * real(sum.force);
    shared.torque = first.volume * first.radius * real(sum.torque) - cross(arm, shared.force);
    return shared;
  }
};

}  // namespace

// Calls visit(i, j, a, b) for spheres i and j of both, a and b in the first's frame, whose parents'
// bounds meet. Opens the larger of two nodes.
template <class Visit>
void SpherePair::for_pairs(const InnerSphereTree& first, const InnerSphereTree& second,
                           const Pose& to_first, const Visit& visit) {
  const Hierarchy &p = first.level.hierarchy, &q = second.level.hierarchy;
  open_.assign(1, {0, 0, placed(to_first, q.nodes[0].bound)});
  while (!open_.empty()) {
    const Place at = open_.back();
    open_.pop_back();
    const HierarchyNode &a = p.nodes[at.first], &b = q.nodes[at.second];
    const double reach = a.bound.radius + at.bound.radius;
    if (squared_norm(a.bound.center - at.bound.center) >= reach * reach) continue;
    const bool a_ends = a.children_are_leaves != 0, b_ends = b.children_are_leaves != 0;
    if (a_ends && b_ends) {
      for (std::uint32_t k = b.begin; k < b.end; ++k) {
        const std::uint32_t j = q.leaves[k];
        const Sphere other = placed(to_first, second.model.spheres[j]);
        for (std::uint32_t l = a.begin; l < a.end; ++l)
          visit(p.leaves[l], j, first.model.spheres[p.leaves[l]], other);
      }
    } else if (b_ends || (!a_ends && a.bound.radius >= at.bound.radius)) {
      for (std::uint32_t k = a.begin; k < a.end; ++k) open_.push_back({k, at.second, at.bound});
    } else {
      for (std::uint32_t k = b.begin; k < b.end; ++k)
        open_.push_back({at.first, k, placed(to_first, q.nodes[k].bound)});
    }
  }
}

SharedSolid SpherePair::measure(const InnerSphereTree& a, const Pose& pose_a,
                                const InnerSphereTree& b, const Pose& pose_b,
                                std::span<SphereState> states) {
  const bool turned = PairOrder(key_of(a), key_of(b)).is_turned(pose_a, pose_b);
  const InnerSphereTree &first = turned ? b : a, &second = turned ? a : b;
  const Pose &at = turned ? pose_b : pose_a, &other_at = turned ? pose_a : pose_b;
  const ToolMeasures measures = measures_of(first.model);
  std::ranges::fill(states, SphereState::outside);
  contacts_ = 0;
  PairSum sum;
  const auto add = [&](std::uint32_t i, std::uint32_t j, const Sphere& s, const Sphere& t) {
    const SphereContact contact = SphereContact::of(s, t);
    if (!(contact.volume > 0)) return;
    ++contacts_;
    sum.add(measures, contact);
    if (states.empty()) return;
    SphereState& state = states[turned ? j : i];
    if (turned ? contact.is_b_inside : contact.is_a_inside) state = SphereState::inside;
    if (state == SphereState::outside) state = SphereState::boundary;
  };
  for_pairs(first, second, relative_to(at, other_at), add);
  SharedSolid shared = sum.result(measures);
  if (shared.volume == 0) return shared;
  const double sign = turned ? -1 : 1;
  shared.force = sign * (at.rotation * shared.force);
  shared.torque = sign * (at.rotation * shared.torque);
  shared.centroid = at * shared.centroid;
  return shared;
}

}  // namespace vpm
