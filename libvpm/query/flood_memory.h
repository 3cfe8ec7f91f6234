// What a coherent sequence of poses remembers of the last one: the shares that were inside, or cut,
// and behind which place of the surface each cluster of shares was.
//
// A tool that has passed wholly behind the surface is cut by nothing, so that the flood has no
// entry: seen alone, such a pose cannot be told from a tool that something merely hides. With the
// memory a share stays inside as long as it is behind the same surface as before: one that is
// still within the tool's reach of where its cluster was. README.md, "Coherent poses".
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

class FloodMemory {
 public:
  FloodMemory(std::size_t shares, std::size_t clusters)
      : inside_(shares), feet_(clusters), known_(clusters) {}

  void forget() {
    std::fill(inside_.begin(), inside_.end(), false);
    std::fill(known_.begin(), known_.end(), false);
  }
  // `read(foot)`: where the share is behind the surface, world coordinates; false if nobody knows.
  // The first of a cluster that is known stands for all of it.
  template <class Read>
  void remember(std::uint32_t share, std::uint32_t cluster, const Read& read) {
    if (!known_[cluster]) known_[cluster] = read(feet_[cluster]);
    inside_[share] = known_[cluster];
  }
  bool was_inside(std::uint32_t share) const { return inside_[share] != 0; }
  bool is_near(std::uint32_t cluster, Vec3 foot, double reach) const {
    return known_[cluster] && squared_norm(foot - feet_[cluster]) <= reach * reach;
  }

 private:
  std::vector<char> inside_;  // of each share
  std::vector<Vec3> feet_;    // of each cluster
  std::vector<char> known_;
};

}  // namespace vpm
