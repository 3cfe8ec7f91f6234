// Tree over the triangles of a surface, four children side by side, whose nodes hold what a pair of
// surfaces asks: a box, a slab |n.x - offset| <= width, and the moments of what they bound.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/model/solid.h"
#include "libvpm/solid/surface_bounds.h"
#include "libvpm/solid/surface_moments.h"

namespace vpm {

class SurfaceTree {
 public:
  using Float4 = float __attribute__((vector_size(16)));
  static constexpr std::uint32_t kNone = 0xffffffffu, kLeaf = 0x80000000u;
  // No path from the root is longer.
  static constexpr std::size_t kMostLevels = 64;

  // Bounds of four children. A child is a node, kLeaf | triangle, or kNone. Node 0 has one child:
  // the whole surface.
  struct Node {
    std::array<Float4, 3> center, half, normal;
    Float4 offset, width, size;
    std::array<std::uint32_t, 4> child;
  };
  // What is known of all triangles below a node.
  struct Summary {
    std::uint32_t first;  // triangle; all below are those from here on, before `end`
    std::uint32_t end;
    std::uint32_t sums;  // place of their moments; kNone where few triangles are summed when asked
    bool is_connected;  // all hang together by vertices: where none is crossed, all are on one side
  };
  // How well a plane stands for what is below a node, for forces.
  struct Patch {
    Vec3f middle;     // mean of the surface
    float radius;     // of its vertices about the middle, or more
    float thickness;  // half of its slab's
    float area;       // of the surface
  };

  // Orders the triangles by the tree and drops none. Needs at least one triangle. `reach` is the
  // largest distance of a vertex from the origin.
  SurfaceTree(std::vector<Vec3> vertices, std::vector<Triangle> triangles, double reach,
              bool with_patches);

  const std::vector<Vec3>& vertices() const { return vertices_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }  // in the tree's order
  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Summary>& summaries() const { return summaries_; }  // of the nodes
  const std::vector<Patch>& patches() const { return patches_; }  // of the nodes; empty without
  // Returns the moments of what is below a node.
  SurfaceMoments moments(std::uint32_t node) const;
  // Returns those with second moments, or null for a node of few triangles.
  const ForceMoments* force_moments(std::uint32_t node) const {
    const std::uint32_t sums = summaries_[node].sums;
    return sums == kNone ? nullptr : &sums_[sums];
  }
  // Returns the node of which the triangle is a child.
  std::uint32_t parent_of(std::uint32_t triangle) const { return parent_of_[triangle]; }
  // Returns the node of which the node is a child; 0 for node 0.
  std::uint32_t node_above(std::uint32_t node) const { return above_[node]; }
  // Returns an upper bound, close to it, of the length of the triangle's longest edge.
  double longest_edge(std::uint32_t triangle) const { return longest_edge_[triangle]; }
  std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const auto& [a, b, c] = triangles_[triangle];
    return {vertices_[a], vertices_[b], vertices_[c]};
  }
  // Returns the bounds of a child of a node.
  SurfaceBounds bounds(std::uint32_t node, std::uint32_t child) const;
  // Returns the closest surface point nearer than `within`; triangle is SurfacePoint::kNone if
  // there is none. Exact in double; of equally near triangles the choice is arbitrary but fixed.
  SurfacePoint closest(Vec3 x, double within = std::numeric_limits<double>::infinity()) const;
  // Returns the bytes held.
  std::size_t bytes() const;

 private:
  class Build;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> parent_of_;
  std::vector<float> longest_edge_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> above_;
  std::vector<Summary> summaries_;
  std::vector<ForceMoments> sums_;
  std::vector<Patch> patches_;
};

}  // namespace vpm
