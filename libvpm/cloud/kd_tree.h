#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

// Nearest neighbours among fixed points. Distances depend on the set of points, not on its order.
// Queries are thread-safe.
class KdTree {
 public:
  explicit KdTree(std::span<const Vec3f> points);

  // Fills `found` with the indices of the n points nearest to `from`, or of all if there are fewer,
  // the nearest first. Which of several at one distance are the last ones is not told.
  void nearest(Vec3f from, int n, std::vector<std::uint32_t>& found) const;

  // Returns the squared distance from `from` to its n-th nearest point (from 1), or to the farthest
  // point if there are fewer.
  double squared_distance(Vec3f from, int n) const;

 private:
  struct Nearest;
  void build(std::size_t begin, std::size_t end);
  void search(std::size_t begin, std::size_t end, Vec3 from, Nearest& nearest) const;

  struct Point {
    Vec3f at;
    std::uint32_t index;  // as it was given
  };

  // The middle of a range is a node; the halves on both sides are its subtrees.
  std::vector<Point> points_;
  std::vector<std::uint8_t> axis_;
};

}  // namespace vpm
