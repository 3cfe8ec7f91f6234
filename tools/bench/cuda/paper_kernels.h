// The kernels of PaperBaseline. Kaluschke, Weller, Zachmann 2017; steps as numbered in
// libvpm/query/README.md.
#pragma once

#include <cstdint>

#include "libvpm/query/ball_fraction.h"
#include "libvpm/query/sphere_location.h"
#include "libvpm/query/tool_sum.h"

namespace vpm::bench {

// Fractional bits of the sums over the points of a sphere, as in PaperMeasure, whose header says
// why they do not overflow.
inline constexpr int kContactBits = 36;

struct Contact {
  std::int64_t points, cap, normal[3], offset[3];
};

struct PaperTotals {
  ToolSum sum;
  std::uint32_t boundary, inside, points;
};

// What kernels see of a tool, a cloud and a run's memory.
struct PaperView {
  static constexpr int kMaxDepth = 64;  // levels of the tree
  static constexpr std::uint32_t kNone = 0xffffffffU;

  const Sphere* spheres;
  std::uint32_t sphere_count;
  const HierarchyNode* nodes;
  const std::uint32_t* leaves;
  const std::uint32_t* graph_begin;
  const std::uint32_t* neighbors;
  Vec3 center_of_mass;
  double reach, volume;  // of the tool

  const Vec3f* positions;
  const Vec3f* normals;
  std::uint32_t point_count;

  Contact* contacts;
  std::uint32_t* states;  // SphereState
  Vec3* sphere_normals;
  std::uint32_t* below;  // the next sphere of the stack that a claimed sphere lies on
  PaperTotals* totals;
};

__device__ inline void add_term(std::int64_t& sum, std::int64_t term) {
  atomicAdd(reinterpret_cast<unsigned long long*>(&sum), static_cast<unsigned long long>(term));
}

__device__ inline void add_sum(const ToolSum& sum, ToolSum& total) {
  add_term(total.volume.value, sum.volume.value);
  for (int k = 0; k < 3; ++k) {
    add_term(total.force[k].value, sum.force[k].value);
    add_term(total.torque[k].value, sum.torque[k].value);
  }
}

// Calls visit(sphere) for every sphere that holds x, by the tree; depth first.
template <class Visit>
__device__ void walk_tree(const PaperView& view, Vec3 x, const Visit& visit) {
  std::uint32_t next[PaperView::kMaxDepth], ends[PaperView::kMaxDepth];
  int size = 0;
  std::uint32_t at = 0, end = 1;  // siblings that have not been looked at
  while (true) {
    if (at == end) {
      if (size == 0) return;
      --size;
      at = next[size], end = ends[size];
      continue;
    }
    const HierarchyNode& node = view.nodes[at++];
    if (!strictly_inside(node.bound, x)) continue;
    if (node.children_are_leaves == 0) {
      next[size] = at, ends[size] = end;
      ++size;
      at = node.begin, end = node.end;
      continue;
    }
    for (std::uint32_t k = node.begin; k < node.end; ++k)
      if (strictly_inside(view.spheres[view.leaves[k]], x)) visit(view.leaves[k]);
  }
}

// Steps 1 and 2: a thread for each point.
__global__ void gather_points(PaperView view, Pose to_tool, Rotation world_to_tool) {
  const std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x;
  if (k >= view.point_count) return;
  const Vec3 x = to_tool * widen(view.positions[k]);
  bool inside = false;
  walk_tree(view, x, [&](std::uint32_t i) {
    inside = true;
    const Sphere& s = view.spheres[i];
    const Vec3 n = world_to_tool * widen(view.normals[k]);
    const Vec3 offset = (x - s.center) / s.radius;
    const double depth = 1 + dot(n, offset);
    const double height = depth < 0 ? 0 : depth > 2 ? 2 : depth;
    using Sum = FixedSum<kContactBits>;
    Contact& c = view.contacts[i];
    add_term(c.points, 1);
    add_term(c.cap, Sum::round(unit_cap_volume(height)));
    add_term(c.normal[0], Sum::round(n.x));
    add_term(c.normal[1], Sum::round(n.y));
    add_term(c.normal[2], Sum::round(n.z));
    add_term(c.offset[0], Sum::round(offset.x));
    add_term(c.offset[1], Sum::round(offset.y));
    add_term(c.offset[2], Sum::round(offset.z));
  });
  if (inside) atomicAdd(&view.totals->points, 1U);
}

__device__ inline Vec3 to_vector(const std::int64_t (&v)[3]) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

// Step 3: a thread for each sphere.
__global__ void find_boundary(PaperView view) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= view.sphere_count) return;
  const Contact& c = view.contacts[i];
  view.states[i] =
      static_cast<std::uint32_t>(c.points == 0 ? SphereState::outside : SphereState::boundary);
  if (c.points == 0) return;
  const Vec3 normal = normalized_or_zero(to_vector(c.normal));
  view.sphere_normals[i] = normal;
  const Sphere& s = view.spheres[i];
  const double per_point = 1 / (FixedSum<kContactBits>::kOne * static_cast<double>(c.points));
  const double cap = s.radius * s.radius * s.radius * (static_cast<double>(c.cap) * per_point);
  const Vec3 at = s.center + s.radius * (per_point * to_vector(c.offset));
  ToolSum sum;
  sum.add(cap / view.volume, normal, (at - view.center_of_mass) / view.reach);
  add_sum(sum, view.totals->sum);
  atomicAdd(&view.totals->boundary, 1U);
}

// Of one thread. Spheres that it has reached and not yet passed are a stack: a list through
// `below`, which has room for all threads since a sphere is claimed once.
struct Traversal {
  const PaperView& view;
  std::uint32_t top = PaperView::kNone;
  ToolSum sum{};  // of all that it claimed
  std::uint32_t claimed = 0;

  // Counts the sphere, if nobody has.
  __device__ void claim(std::uint32_t j, Vec3 normal) {
    constexpr auto kOutside = static_cast<std::uint32_t>(SphereState::outside);
    constexpr auto kInside = static_cast<std::uint32_t>(SphereState::inside);
    if (atomicCAS(&view.states[j], kOutside, kInside) != kOutside) return;
    const Sphere& s = view.spheres[j];
    view.sphere_normals[j] = normal;
    sum.add(volume(s) / view.volume, normal, (s.center - view.center_of_mass) / view.reach);
    ++claimed;
    view.below[j] = top;
    top = j;
  }
  __device__ std::uint32_t pop() {
    const std::uint32_t i = top;
    top = view.below[i];
    return i;
  }
};

// Steps 4 and 5: a traversal for each boundary sphere.
__global__ void flood(PaperView view) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  // A boundary sphere stays one, and no other becomes one: to read while others claim is safe.
  if (i >= view.sphere_count || view.contacts[i].points == 0) return;
  Traversal traversal{view};
  const Vec3 normal = view.sphere_normals[i];
  for (std::uint32_t k = view.graph_begin[i]; k < view.graph_begin[i + 1]; ++k) {
    const std::uint32_t j = view.neighbors[k];
    const Sphere& s = view.spheres[j];
    if (dot(normal, s.center - view.spheres[i].center) > -s.radius) continue;
    traversal.claim(j, normal);
    while (traversal.top != PaperView::kNone) {
      const std::uint32_t passed = traversal.pop();
      for (std::uint32_t n = view.graph_begin[passed]; n < view.graph_begin[passed + 1]; ++n)
        traversal.claim(view.neighbors[n], view.sphere_normals[passed]);
    }
  }
  if (traversal.claimed == 0) return;
  add_sum(traversal.sum, view.totals->sum);
  atomicAdd(&view.totals->inside, traversal.claimed);
}

}  // namespace vpm::bench
