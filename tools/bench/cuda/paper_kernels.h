// Kernels of PaperBaseline, after Kaluschke, Weller, Zachmann 2017. libvpm/measure/README.md
// numbers the steps.
#pragma once

#include <cstdint>

#include "libvpm/backend/cuda/lanes.h"
#include "libvpm/backend/cuda/views.h"
#include "libvpm/backend/sphere_location.h"
#include "libvpm/measure/paper_contact.h"

namespace vpm::bench {

// Views that kernels take of a tool, a cloud and a run's memory.
struct PaperView {
  static constexpr int kMaxDepth = 64;  // levels of the tree
  static constexpr std::uint32_t kNone = 0xffffffffU;

  const Sphere* spheres;
  std::uint32_t sphere_count;
  const HierarchyNode* nodes;
  const std::uint32_t* leaves;
  const std::uint32_t* graph_begin;
  const std::uint32_t* neighbors;
  ToolMeasures tool;

  const Vec3f* positions;
  const Vec3f* normals;
  std::uint32_t point_count;

  PaperContact* contacts;
  std::uint32_t* states;  // SphereState
  Vec3* sphere_normals;
  std::uint32_t* below;  // next sphere on the stack that holds a claimed sphere
  cuda::RawResult* totals;
};

// Calls visit(sphere) for every sphere that holds x, by the tree; depth first.
template <class Visit>
__device__ void walk_tree(const PaperView& view, Vec3 x, const Visit& visit) {
  std::uint32_t next[PaperView::kMaxDepth], ends[PaperView::kMaxDepth];
  int size = 0;
  std::uint32_t at = 0, end = 1;  // siblings still to be visited
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

// Does steps 1 and 2, with a thread for each point.
__global__ void gather_points(PaperView view, Pose to_tool, Rotation world_to_tool) {
  const std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x;
  if (k >= view.point_count) return;
  const Vec3 x = to_tool * widen(view.positions[k]);
  bool inside = false;
  walk_tree(view, x, [&](std::uint32_t i) {
    inside = true;
    const Sphere& s = view.spheres[i];
    const Vec3 n = world_to_tool * widen(view.normals[k]);
    PaperContact::of_point(s, x, n).add_to(view.contacts[i], cuda::add_term);
  });
  if (inside) atomicAdd(&view.totals->points, 1U);
}

// Does step 3, with a thread for each sphere.
__global__ void find_boundary(PaperView view) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= view.sphere_count) return;
  const PaperContact& c = view.contacts[i];
  view.states[i] =
      static_cast<std::uint32_t>(c.points == 0 ? SphereState::outside : SphereState::boundary);
  if (c.points == 0) return;
  const Vec3 normal = c.mean_normal();
  view.sphere_normals[i] = normal;
  ToolSum sum;
  add_boundary(view.tool, view.spheres[i], c, normal, sum);
  cuda::add_atomically(sum, view.totals->sum);
  atomicAdd(&view.totals->boundary, 1U);
}

// Traversal of one thread. Spheres that it has reached and not yet passed are a stack: a list
// through `below`, which has room for all threads since a sphere is claimed once.
struct Traversal {
  const PaperView& view;
  std::uint32_t top = PaperView::kNone;
  ToolSum sum{};  // sum of all spheres that it claimed
  std::uint32_t claimed = 0;

  // Counts the sphere unless another thread has counted it.
  __device__ void claim(std::uint32_t j, Vec3 normal) {
    constexpr auto kOutside = static_cast<std::uint32_t>(SphereState::outside);
    constexpr auto kInside = static_cast<std::uint32_t>(SphereState::inside);
    if (atomicCAS(&view.states[j], kOutside, kInside) != kOutside) return;
    view.sphere_normals[j] = normal;
    add_inside(view.tool, view.spheres[j], normal, sum);
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

// Floods from the neighbours first, first + step, ... of a boundary sphere.
__device__ void flood_from(const PaperView& view, std::uint32_t i, std::uint32_t first,
                           std::uint32_t step) {
  Traversal traversal{view};
  const Vec3 normal = view.sphere_normals[i];
  for (std::uint32_t k = view.graph_begin[i] + first; k < view.graph_begin[i + 1]; k += step) {
    const std::uint32_t j = view.neighbors[k];
    if (!lets_in(view.spheres[i], normal, view.spheres[j])) continue;
    traversal.claim(j, normal);
    while (traversal.top != PaperView::kNone) {
      const std::uint32_t passed = traversal.pop();
      for (std::uint32_t n = view.graph_begin[passed]; n < view.graph_begin[passed + 1]; ++n)
        traversal.claim(view.neighbors[n], view.sphere_normals[passed]);
    }
  }
  if (traversal.claimed == 0) return;
  cuda::add_atomically(traversal.sum, view.totals->sum);
  atomicAdd(&view.totals->inside, traversal.claimed);
}

// True for a boundary sphere. It stays one, and no other becomes one, so reading while others claim
// is safe.
__device__ bool is_boundary(const PaperView& view, std::uint32_t i) {
  return i < view.sphere_count && view.contacts[i].points != 0;
}

// Does steps 4 and 5, with a traversal for each boundary sphere.
__global__ void flood(PaperView view) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (is_boundary(view, i)) flood_from(view, i, 0, 1);
}

// Traverses from one boundary sphere, with a thread for each of its neighbours.
__global__ void flood_of_sphere(PaperView view, std::uint32_t i) {
  flood_from(view, i, threadIdx.x, blockDim.x);
}

// Does steps 4 and 5 with dynamic parallelism: the thread of a boundary sphere launches its
// traversal, if there is one.
__global__ void flood_by_launches(PaperView view) {
  constexpr std::uint32_t kMostThreads = 256;
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (!is_boundary(view, i)) return;
  const std::uint32_t begin = view.graph_begin[i], end = view.graph_begin[i + 1];
  const Vec3 normal = view.sphere_normals[i];
  bool enters = false;
  for (std::uint32_t k = begin; k < end && !enters; ++k)
    enters = lets_in(view.spheres[i], normal, view.spheres[view.neighbors[k]]);
  if (!enters) return;
  flood_of_sphere<<<1, min(end - begin, kMostThreads), 0, cudaStreamFireAndForget>>>(view, i);
  // Floods in this thread if more launches wait than the device has room for.
  if (cudaGetLastError() != cudaSuccess) flood_from(view, i, 0, 1);
}

}  // namespace vpm::bench
