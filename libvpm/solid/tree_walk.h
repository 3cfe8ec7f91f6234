// Finds the pairs of triangles of two trees whose bounds meet.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/solid/surface_tree.h"
#include "libvpm/solid/triangle_pair.h"

namespace vpm {

// Bounds of a piece of a surface, to be asked by nodes of the other, in whose frame they are
// placed.
class PlacedBounds {
 public:
  // `pose` maps the piece's frame to the nodes'.
  PlacedBounds(const SurfaceBounds& piece, const Pose& pose);

  // Returns a mask of the node's children whose bounds meet these. Never misses one that meets.
  unsigned children_that_meet(const SurfaceTree::Node& node) const;

 private:
  FloatPose pose_;
  std::array<float, 3> own_half_;                // of the box, along its own axes
  std::array<float, 3> center_, half_, normal_;  // in the nodes' frame
  float offset_, width_;                         // of the slab, from the box's centre
};

class TreeWalk {
 public:
  // Returns the pairs of triangles that may meet, each once, by their indices. `pose` maps b's
  // frame to a's. The pairs are kept by the walk, and hold until the next call.
  std::span<const CandidatePair> run(const SurfaceTree& a, const SurfaceTree& b, const Pose& pose);

 private:
  // Children of two nodes, in masks, of which each of the one may meet each of the other.
  struct Place {
    std::uint32_t a, b;  // nodes
    unsigned children;   // bit 4 k + l: of a's l and b's k
  };
  void list(const SurfaceTree::Node& p, const SurfaceTree::Node& q, unsigned pairs);
  void push(const SurfaceTree& a, const SurfaceTree& b, Place place, unsigned larger_of_a,
            unsigned larger_of_b, unsigned alike);

  std::vector<Place> stack_;
  std::vector<CandidatePair> found_;  // the first `count_`
  std::size_t count_ = 0;
};

}  // namespace vpm
