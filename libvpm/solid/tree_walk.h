// Finds the pairs of triangles of two trees whose bounds meet.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/solid/surface_tree.h"

namespace vpm {

// Motion from one frame to another in floats, for bounds that are padded for that.
struct FloatPose {
  explicit FloatPose(const Pose& pose);
  std::array<float, 9> rotation, size;  // rows; size: magnitudes, a little more
  std::array<float, 3> translation;
};

// Returns a mask of the node's children whose bounds meet those of a piece of the other surface.
// `pose` maps the other's frame to the node's. Never misses one that meets.
unsigned children_that_meet(const SurfaceTree::Node& node, const SurfaceBounds& other,
                            const FloatPose& pose);

class TreeWalk {
 public:
  // Calls take(triangle of a, triangle of b) for pairs that may meet. `pose` maps b's frame to a's.
  template <class Take>
  void run(const SurfaceTree& a, const SurfaceTree& b, const Pose& pose, const Take& take) {
    const FloatPose to_a(pose), to_b(inverse(pose));
    stack_.clear();
    stack_.push_back({{0, 0}, {0, 0}});
    while (!stack_.empty()) {
      const auto [p, q] = stack_.back();
      stack_.pop_back();
      const SurfaceTree::Node &node_p = a.nodes()[p.node], &node_q = b.nodes()[q.node];
      const std::uint32_t child_p = node_p.child[p.child], child_q = node_q.child[q.child];
      if ((child_p & child_q & SurfaceTree::kLeaf) != 0) {
        take(child_p & ~SurfaceTree::kLeaf, child_q & ~SurfaceTree::kLeaf);
        continue;
      }
      // The larger of the two is opened; a triangle has size 0.
      if (node_p.size[static_cast<int>(p.child)] > node_q.size[static_cast<int>(q.child)]) {
        const unsigned meets =
            children_that_meet(a.nodes()[child_p], b.bounds(q.node, q.child), to_a);
        for (std::uint32_t k = 0; k < 4; ++k)
          if ((meets >> k & 1) != 0) stack_.push_back({{child_p, k}, q});
      } else {
        const unsigned meets =
            children_that_meet(b.nodes()[child_q], a.bounds(p.node, p.child), to_b);
        for (std::uint32_t k = 0; k < 4; ++k)
          if ((meets >> k & 1) != 0) stack_.push_back({p, {child_q, k}});
      }
    }
  }

 private:
  struct Place {
    std::uint32_t node, child;
  };
  std::vector<std::pair<Place, Place>> stack_;
};

}  // namespace vpm
