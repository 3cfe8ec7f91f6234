// What a coherent sequence of poses remembers of the last one: the shares that were inside, or cut,
// and behind which place of the surface each cluster of shares was.
//
// A tool that has passed wholly behind the surface is cut by nothing: seen alone, what is far
// behind the surface there cannot be told from what something merely hides. With the memory a share
// stays inside as long as it is behind the same surface as before: one that is still within the
// tool's reach of where its cluster was. README.md, "Coherent poses".
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/surface/surface.h"

namespace vpm {

class PoseMemory {
 public:
  PoseMemory(std::size_t shares, std::size_t clusters)
      : last_(shares, clusters), next_(shares, clusters) {}

  bool was_inside(std::uint32_t share) const { return last_.inside[share] != 0; }
  bool is_near(std::uint32_t cluster, Vec3 foot, double reach) const {
    return last_.known[cluster] && squared_norm(foot - last_.feet[cluster]) <= reach * reach;
  }
  // The plane in which the surface cut the tool when it last did.
  const TangentPlane& touched() const { return touched_; }
  void touch(const TangentPlane& plane) { touched_ = plane; }
  void forget(std::uint32_t share) { last_.inside[share] = false; }
  void forget() { last_.clear(); }

  // `foot`: where the share is behind the surface, world coordinates. The first of a cluster stands
  // for all of it.
  void remember(std::uint32_t share, std::uint32_t cluster, Vec3 foot) {
    if (!next_.known[cluster]) next_.feet[cluster] = foot;
    next_.known[cluster] = next_.inside[share] = true;
  }
  bool is_known(std::uint32_t cluster) const { return next_.known[cluster] != 0; }
  // Of a cluster that is known.
  void remember(std::uint32_t share) { next_.inside[share] = true; }
  // When all is remembered: it replaces what was.
  void turn() {
    std::swap(last_, next_);
    next_.clear();
  }

 private:
  struct Memory {
    Memory(std::size_t shares, std::size_t clusters)
        : inside(shares), feet(clusters), known(clusters) {}
    void clear() {
      std::fill(inside.begin(), inside.end(), false);
      std::fill(known.begin(), known.end(), false);
    }
    std::vector<char> inside;  // of each share
    std::vector<Vec3> feet;    // of each cluster
    std::vector<char> known;
  };
  Memory last_, next_;
  TangentPlane touched_;
};

}  // namespace vpm
