#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

// Nearest neighbours among points that do not change. Distances depend on the set of points only,
// not on their order. Queries are thread-safe.
class KdTree {
 public:
  explicit KdTree(std::vector<Vec3f> points);

  // Squared distance from `from` to its n-th nearest point (1: the nearest), or to the farthest if
  // there are fewer.
  double squared_distance(Vec3f from, int n) const;

 private:
  struct Nearest;
  void build(std::size_t begin, std::size_t end);
  void search(std::size_t begin, std::size_t end, Vec3 from, Nearest& nearest) const;

  // A node is the middle of its range; the halves beside it are its children.
  std::vector<Vec3f> points_;
  std::vector<std::uint8_t> axis_;
};

}  // namespace vpm
