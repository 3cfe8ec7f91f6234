#include "libvpm/mesh/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/mesh/closest_point.h"

namespace vpm {
namespace {

constexpr std::size_t kLeafTriangles = 4;
// Float boxes grow by this share of the mesh's extent, and squared bounds are compared with this
// slack: several float roundings, so that a box never hides its triangles.
constexpr double kBoxPadding = 0x1p-21;
constexpr float kBoundSlack = 1.0f + 0x1p-20f;

double component(Vec3 v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

Vec3 centroid(const TriangleBvh::Corners& t) {
  return (t.a + t.b + t.c) / 3.0;
}

}  // namespace

struct TriangleBvh::Build {
  TriangleBvh& bvh;
  double padding;

  // Halves [begin, end) about the median centroid along the longest side of the centroids' box.
  std::size_t split(std::size_t begin, std::size_t end) {
    Box box;
    for (std::size_t i = begin; i < end; ++i) box.add(centroid(bvh.corners_[i]));
    const Vec3 side = box.high - box.low;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const std::size_t middle = begin + (end - begin + 1) / 2;
    const auto first = bvh.corners_.begin();
    std::nth_element(
        first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(middle),
        first + static_cast<std::ptrdiff_t>(end), [axis](const Corners& s, const Corners& t) {
          const double p = component(centroid(s), axis);
          const double q = component(centroid(t), axis);
          return p != q ? p < q : s.triangle < t.triangle;
        });
    return middle;
  }

  void set_box(Node& node, int slot, std::size_t begin, std::size_t end) {
    Box box;
    for (std::size_t i = begin; i < end; ++i) {
      box.add(bvh.corners_[i].a);
      box.add(bvh.corners_[i].b);
      box.add(bvh.corners_[i].c);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double origin = component(bvh.origin_, axis);
      node.low[axis][slot] = static_cast<float>(component(box.low, axis) - origin - padding);
      node.high[axis][slot] = static_cast<float>(component(box.high, axis) - origin + padding);
    }
  }

  std::uint32_t build(std::size_t begin, std::size_t end) {
    const auto index = static_cast<std::uint32_t>(bvh.nodes_.size());
    Node node;
    for (int slot = 0; slot < 4; ++slot) {  // empty boxes are infinitely far from everything
      for (int axis = 0; axis < 3; ++axis) node.low[axis][slot] = node.high[axis][slot] = HUGE_VALF;
      node.child[slot] = node.count[slot] = 0;
    }
    bvh.nodes_.push_back(node);
    std::array<std::size_t, 5> cut{begin, end, end, end, end};
    int parts = 1;
    if (end - begin > kLeafTriangles) {
      const std::size_t middle = split(begin, end);
      const std::size_t left = middle - begin > kLeafTriangles ? split(begin, middle) : middle;
      const std::size_t right = end - middle > kLeafTriangles ? split(middle, end) : end;
      cut = {begin, left, middle, right, end};
      parts = 4;
    }
    for (int slot = 0; slot < parts; ++slot) {
      const std::size_t from = cut[static_cast<std::size_t>(slot)];
      const std::size_t to = cut[static_cast<std::size_t>(slot) + 1];
      if (from == to) continue;
      set_box(node, slot, from, to);
      const bool leaf = to - from <= kLeafTriangles;
      node.count[slot] = leaf ? static_cast<std::uint32_t>(to - from) : 0;
      node.child[slot] = leaf ? static_cast<std::uint32_t>(from) : build(from, to);
    }
    bvh.nodes_[index] = node;
    return index;
  }
};

TriangleBvh::TriangleBvh(const std::vector<Vec3>& vertices,
                         const std::vector<Triangle>& triangles) {
  if (triangles.empty()) refuse("the mesh has no triangles; a solid needs at least four");
  Box box;
  corners_.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t v : triangles[i]) {
      if (v >= vertices.size() || !is_finite(vertices[v])) {
        refuse("triangle " + std::to_string(i) + " names vertex " + std::to_string(v) +
               (v < vertices.size() ? ", which is not finite" : ", which does not exist") +
               "; repair the mesh");
      }
      box.add(vertices[v]);
    }
    const auto [a, b, c] = triangles[i];
    corners_.push_back({vertices[a], vertices[b], vertices[c], static_cast<std::uint32_t>(i)});
  }
  origin_ = box.low + 0.5 * (box.high - box.low);
  const Vec3 side = box.high - box.low;
  nodes_.reserve(triangles.size() / 2 + 1);
  Build{*this, kBoxPadding * std::max({side.x, side.y, side.z})}.build(0, corners_.size());
  nodes_.shrink_to_fit();
}

SurfacePoint TriangleBvh::closest(Vec3 x, double within) const {
  SurfacePoint best;
  double best2 = within * within;
  const Vec3 local = x - origin_;
  const float at[3] = {static_cast<float>(local.x), static_cast<float>(local.y),
                       static_cast<float>(local.z)};
  struct Pending {
    float bound2;
    std::uint32_t child, count;
  };
  // Each level leaves at most three siblings behind, and a level quarters the triangles.
  std::array<Pending, 64> stack;
  std::size_t top = 0;
  stack[top++] = {0.0f, 0, 0};
  while (top > 0) {
    const Pending entry = stack[--top];
    if (entry.bound2 > static_cast<float>(best2) * kBoundSlack) continue;
    if (entry.count > 0) {
      for (std::uint32_t i = entry.child; i < entry.child + entry.count; ++i) {
        const Corners& t = corners_[i];
        const Vec3 p = closest_point_on_triangle(x, t.a, t.b, t.c);
        const double d2 = squared_norm(x - p);
        if (d2 < best2) {
          best2 = d2;
          best.point = p;
          best.triangle = i;
        }
      }
      continue;
    }
    const Node& node = nodes_[entry.child];
    Float4 bound2{};
    for (int axis = 0; axis < 3; ++axis) {
      const Float4 below = node.low[axis] - at[axis], above = at[axis] - node.high[axis];
      const Float4 outside = below > above ? below : above;
      const Float4 gap = outside > Float4{} ? outside : Float4{};
      bound2 += gap * gap;
    }
    const std::size_t base = top;
    for (int slot = 0; slot < 4; ++slot) {  // nearest child last, so that it is next
      if (!(bound2[slot] <= static_cast<float>(best2) * kBoundSlack)) continue;
      if (node.count[slot] == 0 && node.child[slot] == 0) continue;
      std::size_t place = top++;
      for (; place > base && stack[place - 1].bound2 < bound2[slot]; --place)
        stack[place] = stack[place - 1];
      stack[place] = {bound2[slot], node.child[slot], node.count[slot]};
    }
  }
  if (best.triangle != SurfacePoint::kNone) {
    best.distance = std::sqrt(best2);
    best.triangle = corners_[best.triangle].triangle;
  }
  return best;
}

std::size_t TriangleBvh::around(Vec3 x, double half, std::span<std::uint32_t> found) const {
  const Vec3 at = x - origin_;
  const auto apart = [&](Vec3 low, Vec3 high, Vec3 y) {
    return low.x > y.x + half || high.x < y.x - half || low.y > y.y + half || high.y < y.y - half ||
           low.z > y.z + half || high.z < y.z - half;
  };
  std::array<std::uint32_t, 64> stack;  // see closest
  std::size_t top = 0, count = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    for (int slot = 0; slot < 4; ++slot) {
      const std::uint32_t child = node.child[slot], triangles = node.count[slot];
      if (triangles == 0 && child == 0) continue;
      const auto corner = [&](const Float4* box) {
        return Vec3{double{box[0][slot]}, double{box[1][slot]}, double{box[2][slot]}};
      };
      if (apart(corner(node.low), corner(node.high), at)) continue;
      if (triangles == 0) stack[top++] = child;
      for (std::uint32_t i = child; i < child + triangles; ++i) {
        const auto& [a, b, c, index] = corners_[i];
        if (apart({std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})},
                  {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})},
                  x))
          continue;
        if (count == found.size()) return count + 1;
        found[count++] = i;
      }
    }
  }
  return count;
}

}  // namespace vpm
