// Closest points on a surface, by the boxes and slabs of its tree: the slab of a flat piece is a
// far better bound beside it than its box.
#include <array>
#include <bit>
#include <cmath>

#include "libvpm/core/lanes.h"
#include "libvpm/core/vec3x4.h"
#include "libvpm/mesh/closest_lanes.h"
#include "libvpm/solid/surface_tree.h"

namespace vpm {
namespace {

// Slack of squared bounds: several float roundings, so that bounds never hide what is nearest.
constexpr float kBoundSlack = 1.0f + 0x1p-20f;

// Squared distances that the children of a node have at least from a place.
[[gnu::always_inline]] inline Float4 least_distance2(const SurfaceTree::Node& node, Vec3f x) {
  const Float4 zero{};
  const std::array<float, 3> at{x.x, x.y, x.z};
  Float4 from_box2{}, height = -node.offset;
  for (std::size_t i = 0; i < 3; ++i) {
    const Float4 outside = absolute(node.center[i] - at[i]) - node.half[i];
    const Float4 gap = outside > zero ? outside : zero;
    from_box2 += gap * gap;
    height += node.normal[i] * at[i];
  }
  const Float4 beside = absolute(height) - node.width;
  const Float4 from_slab = beside > zero ? beside : zero, from_slab2 = from_slab * from_slab;
  return from_slab2 > from_box2 ? from_slab2 : from_box2;
}

// Updates `best` with the closest point on one to four triangles, if it is nearer than `best2`.
[[gnu::always_inline]] inline void take_closest(const SurfaceTree& tree,
                                                std::span<const std::uint32_t> triangles, Vec3 x,
                                                SurfacePoint& best, double& best2) {
  const auto [s, t, u, v] = four_of(triangles, 0);
  const auto [a, b, c] = tree.corners(s);
  const auto [d, e, f] = tree.corners(t);
  const auto [g, h, i] = tree.corners(u);
  const auto [j, k, l] = tree.corners(v);
  Vec3x4 p;
  Double4 d2;
  closest_points_on_triangles({x, x, x, x}, {a, d, g, j}, {b, e, h, k}, {c, f, i, l}, best2, p, d2);
  for (std::size_t lane = 0; lane < triangles.size(); ++lane) {
    const auto at = static_cast<int>(lane);
    if (!(d2[at] < best2)) continue;
    best2 = d2[at];
    best.point = p.of(at);
    best.triangle = triangles[lane];
  }
}

}  // namespace

VPM_VECTOR_CLONES
SurfacePoint SurfaceTree::closest(Vec3 x, double within) const {
  struct Pending {
    float bound2;
    std::uint32_t node;
  };
  const Vec3f at = narrow(x);
  SurfacePoint best;
  double best2 = within * within;
  std::array<Pending, 3 * kMostLevels> stack;  // each level leaves at most three siblings
  std::size_t top = 0;
  stack[top++] = {0, 0};
  while (top > 0) {
    const auto [bound, index] = stack[--top];
    if (bound > static_cast<float>(best2) * kBoundSlack) continue;
    const Node& node = nodes_[index];
    const Float4 bound2 = least_distance2(node, at);
    std::array<std::uint32_t, 4> triangles;
    std::size_t count = 0, base = top;
    for (unsigned near = mask_of(bound2 <= static_cast<float>(best2) * kBoundSlack); near != 0;
         near &= near - 1) {
      const int slot = std::countr_zero(near);
      const std::uint32_t child = node.child[static_cast<std::size_t>(slot)];
      if (child == kNone) continue;
      if ((child & kLeaf) != 0) {
        triangles[count++] = child & ~kLeaf;
        continue;
      }
      prefetch(&nodes_[child]);
      std::size_t place = top++;  // the nearest child last, so that it is next
      for (; place > base && stack[place - 1].bound2 < bound2[slot]; --place)
        stack[place] = stack[place - 1];
      stack[place] = {bound2[slot], child};
    }
    if (count > 0) take_closest(*this, std::span(triangles).first(count), x, best, best2);
  }
  if (best.triangle != SurfacePoint::kNone) best.distance = std::sqrt(best2);
  return best;
}

}  // namespace vpm
