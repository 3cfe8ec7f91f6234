// What a coherent sequence of poses remembers of the last one: the shares that were inside, or cut,
// and behind which place of the surface each was.
//
// A tool that has passed wholly behind the surface is cut by nothing, so that the flood has no
// entry: seen alone, such a pose cannot be told from a tool that something merely hides. With the
// memory a share stays inside as long as it is behind the same surface as before: one that is
// still within the tool's reach of where it was. README.md, "Coherent poses".
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

class FloodMemory {
 public:
  explicit FloodMemory(std::uint32_t shares) : feet_(shares), known_(shares) {}

  void forget() { std::fill(known_.begin(), known_.end(), false); }
  // `foot`: world coordinates.
  void remember(std::uint32_t share, Vec3 foot) {
    feet_[share] = foot;
    known_[share] = true;
  }
  bool was_behind(std::uint32_t share, Vec3 foot, double reach) const {
    return known_[share] && squared_norm(foot - feet_[share]) <= reach * reach;
  }

 private:
  std::vector<Vec3> feet_;
  std::vector<char> known_;
};

}  // namespace vpm
