#include "libvpm/mesh/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <compare>
#include <functional>
#include <vector>

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/core/lanes.h"
#include "libvpm/core/parallel.h"
#include "libvpm/core/vec3x4.h"
#include "libvpm/mesh/closest_lanes.h"
#include "libvpm/mesh/halving.h"

namespace vpm {
namespace {

constexpr std::size_t kLeafTriangles = 4;
// Padding of float boxes relative to the mesh's extent, and slack of squared bounds: several float
// roundings, so that a box never hides its triangles.
constexpr double kBoxPadding = 0x1p-21;
constexpr float kBoundSlack = 1.0f + 0x1p-20f;

// Updates `best` with the closest point on up to four triangles, if it is nearer than `best2`.
[[gnu::always_inline]] inline void take_closest(const TriangleBvh::Corners* first,
                                                std::uint32_t count, Vec3 x, SurfacePoint& best,
                                                double& best2) {
  const auto [s, t, u, v] = four_of(std::span(first, count), 0);
  Vec3x4 p;
  Double4 d2;
  closest_points_on_triangles({x, x, x, x}, {s.a, t.a, u.a, v.a}, {s.b, t.b, u.b, v.b},
                              {s.c, t.c, u.c, v.c}, best2, p, d2);
  for (std::uint32_t k = 0; k < count; ++k) {
    if (!(d2[k] < best2)) continue;
    best2 = d2[k];
    best.point = p.of(static_cast<int>(k));
    best.triangle = first[k].triangle;
  }
}

}  // namespace

struct TriangleBvh::Build {
  struct Item {
    Vec3 middle;
    std::uint32_t index;  // of the triangle
  };

  TriangleBvh& bvh;
  double padding;
  std::vector<Item> items;  // in the order of the leaves

  void set_box(Node& node, int slot, const Box& box) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double origin = coordinate(bvh.origin_, axis);
      node.low[axis][slot] = static_cast<float>(coordinate(box.low, axis) - origin - padding);
      node.high[axis][slot] = static_cast<float>(coordinate(box.high, axis) - origin + padding);
    }
  }

  // Builds the nodes of [begin, end) and returns their bounding box.
  Box build(std::size_t begin, std::size_t end) {
    const std::size_t index = bvh.nodes_.size();
    Node node;
    for (int slot = 0; slot < 4; ++slot) {  // empty boxes are infinitely far from everything
      for (int axis = 0; axis < 3; ++axis) node.low[axis][slot] = node.high[axis][slot] = HUGE_VALF;
      node.child[slot] = node.count[slot] = 0;
    }
    bvh.nodes_.push_back(node);
    std::array<std::size_t, 5> cut{begin, end, end, end, end};
    int parts = 1;
    if (end - begin > kLeafTriangles) {
      const std::size_t middle = half_of(begin, end);
      const std::size_t left = middle - begin > kLeafTriangles ? half_of(begin, middle) : middle;
      const std::size_t right = end - middle > kLeafTriangles ? half_of(middle, end) : end;
      cut = {begin, left, middle, right, end};
      parts = 4;
    }
    Box all;
    for (int slot = 0; slot < parts; ++slot) {
      const std::size_t from = cut[static_cast<std::size_t>(slot)];
      const std::size_t to = cut[static_cast<std::size_t>(slot) + 1];
      if (from == to) continue;
      const bool leaf = to - from <= kLeafTriangles;
      node.count[slot] = leaf ? static_cast<std::uint32_t>(to - from) : 0;
      node.child[slot] = static_cast<std::uint32_t>(leaf ? from : bvh.nodes_.size());
      const Box box = leaf ? box_of(from, to) : build(from, to);
      set_box(node, slot, box);
      all.add(box.low);
      all.add(box.high);
    }
    bvh.nodes_[index] = node;
    return all;
  }

  Box box_of(std::size_t begin, std::size_t end) const {
    Box box;
    for (std::size_t i = begin; i < end; ++i) {
      box.add(bvh.corners_[i].a);
      box.add(bvh.corners_[i].b);
      box.add(bvh.corners_[i].c);
    }
    return box;
  }
};

TriangleBvh::TriangleBvh(const std::vector<Vec3>& vertices,
                         const std::vector<Triangle>& triangles) {
  if (triangles.empty()) refuse("the mesh has no triangles", {}, "a solid needs at least four");
  Box box;
  std::vector<Build::Item> items;
  items.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t v : triangles[i]) {
      if (v >= vertices.size() || !is_finite(vertices[v])) {
        refuse("triangle " + std::to_string(i) + " names vertex " + std::to_string(v) +
                   (v < vertices.size() ? ", which is not finite" : ", which does not exist"),
               {}, "repair the mesh");
      }
      box.add(vertices[v]);
    }
    const auto [a, b, c] = triangles[i];
    items.push_back(
        {(vertices[a] + vertices[b] + vertices[c]) / 3.0, static_cast<std::uint32_t>(i)});
  }
  origin_ = box.low + 0.5 * (box.high - box.low);
  const Vec3 side = box.high - box.low;
  nodes_.reserve(triangles.size() / 2 + 1);
  Build build{*this, kBoxPadding * std::max({side.x, side.y, side.z}), std::move(items)};
  halve_down(build.items, {{0, triangles.size()}}, kLeafTriangles);
  corners_.reserve(triangles.size());
  for (const Build::Item& item : build.items) {
    const auto [a, b, c] = triangles[item.index];
    corners_.push_back({vertices[a], vertices[b], vertices[c], item.index});
  }
  build.build(0, corners_.size());
  nodes_.shrink_to_fit();
}

VPM_VECTOR_CLONES
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
  // Each level leaves at most three siblings, and each level quarters the triangles.
  std::array<Pending, 64> stack;
  std::size_t top = 0;
  stack[top++] = {0.0f, 0, 0};
  while (top > 0) {
    const Pending entry = stack[--top];
    if (entry.bound2 > static_cast<float>(best2) * kBoundSlack) continue;
    if (entry.count > 0) {
      take_closest(&corners_[entry.child], entry.count, x, best, best2);
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
      const std::uint32_t child = node.child[slot], count = node.count[slot];
      if (count == 0 && child == 0) continue;
      count > 0 ? prefetch(&corners_[child], count) : prefetch(&nodes_[child]);
      std::size_t place = top++;
      for (; place > base && stack[place - 1].bound2 < bound2[slot]; --place)
        stack[place] = stack[place - 1];
      stack[place] = {bound2[slot], child, count};
    }
  }
  if (best.triangle != SurfacePoint::kNone) best.distance = std::sqrt(best2);
  return best;
}

std::size_t TriangleBvh::around(Vec3 x, double half, std::span<std::uint32_t> found) const {
  const Vec3 at = x - origin_;
  const auto apart = [&](Vec3 low, Vec3 high, Vec3 y) {
    return low.x > y.x + half || high.x < y.x - half || low.y > y.y + half || high.y < y.y - half ||
           low.z > y.z + half || high.z < y.z - half;
  };
  std::array<std::uint32_t, 64> stack;  // large enough, see closest()
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

namespace {

// Limits the samples along an edge, for triangles as large as the mesh.
constexpr double kMaxSteps = 2000;

// Triangular lattice on a triangle, of at most `spacing` between samples.
struct Lattice {
  Vec3 a, b, c;
  int steps;

  Lattice(const Solid& solid, const Triangle& t, double spacing)
      : a(solid.vertices[t[0]]), b(solid.vertices[t[1]]), c(solid.vertices[t[2]]) {
    const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
    steps = static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, kMaxSteps));
  }

  Vec3 sample(int i, int j) const {
    return a + (static_cast<double>(i) / steps) * (b - a) +
           (static_cast<double>(j) / steps) * (c - a);
  }
  Vec3 middle() const { return (a + b + c) / 3; }
  // Returns the largest distance of a sample from the middle, in metres.
  double radius() const {
    const Vec3 m = middle();
    return std::max({norm(a - m), norm(b - m), norm(c - m)});
  }
  // Returns more than rounding changes in a distance from here.
  double slack() const {
    constexpr double kRounding = 1e-12;  // thousands of the last place
    return kRounding * (norm(a) + norm(b) + norm(c));
  }
};

// Raises `largest` to the value, if that is larger.
void raise(std::atomic<double>& largest, double value) {
  double before = largest.load();
  while (before < value && !largest.compare_exchange_weak(before, value)) {
  }
}

// Raises `largest` to the largest distance of a lattice's samples. A distance changes no faster
// than the place, so that samples near one that lies close are passed over.
void raise_to_farthest(const Lattice& lattice, const TriangleBvh& to,
                       std::atomic<double>& largest) {
  const double step = norm(lattice.c - lattice.a) / lattice.steps, slack = lattice.slack();
  for (int i = 0; i <= lattice.steps; ++i) {
    for (int j = 0; i + j <= lattice.steps; ++j) {
      const double distance = to.closest(lattice.sample(i, j)).distance;
      raise(largest, distance);
      const double room = largest.load() - distance - slack;
      if (room > step * lattice.steps) break;
      if (room > step) j += static_cast<int>(room / step);
    }
  }
}

}  // namespace

double farthest_from_surface(const Solid& from, const Solid& to, double spacing) {
  const TriangleBvh bvh(to.vertices, to.triangles);
  // Triangles in which the farthest point may lie go first, and most others are not looked at.
  struct Bound {
    double distance;
    std::size_t triangle;
    auto operator<=>(const Bound&) const = default;
  };
  std::vector<Bound> bounds(from.triangles.size());
  constexpr std::size_t kTogether = 16;
  parallel_for(bounds.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Lattice lattice(from, from.triangles[k], spacing);
      bounds[k] = {bvh.closest(lattice.middle()).distance + lattice.radius() + lattice.slack(), k};
    }
  });
  std::sort(bounds.begin(), bounds.end(), std::greater<>());
  std::atomic<double> largest = 0;
  parallel_for(bounds.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end && bounds[k].distance > largest.load(); ++k)
      raise_to_farthest(Lattice(from, from.triangles[bounds[k].triangle], spacing), bvh, largest);
  });
  return largest;
}

}  // namespace vpm
