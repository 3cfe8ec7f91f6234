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

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/scene/surface.h"

namespace vpm {

class PoseMemory {
 public:
  PoseMemory(std::size_t cells, std::size_t clusters)
      : last_(cells, clusters), next_(cells, clusters) {}

  bool was_inside(std::uint32_t cell) const { return last_.inside[cell] != 0; }
  // Calls visit(share) for those that were.
  template <class Visit>
  void for_cells(const Visit& visit) const {
    for (const Rows& rows : last_.remembered) {
      for (std::uint32_t cell = rows.begin; cell < rows.end; ++cell)
        if (was_inside(cell)) visit(cell);
    }
  }
  bool is_near(std::uint32_t cluster, Vec3 foot, double reach) const {
    return last_.known[cluster] && squared_norm(foot - last_.feet[cluster]) <= reach * reach;
  }
  // The plane in which the surface cut the tool when it last did.
  const TangentPlane& touched() const { return touched_; }
  void touch(const TangentPlane& plane) { touched_ = plane; }
  void forget(std::uint32_t cell) { last_.inside[cell] = false; }
  void forget() { last_.clear(); }

  // `foot`: where a share of the cluster, not known yet, is behind the surface, world coordinates.
  void remember(std::uint32_t index, const CellCluster& cluster, Vec3 foot) {
    next_.feet[index] = foot;
    next_.known[index] = true;
    next_.remembered.push_back({index, cluster.begin, cluster.end});
  }
  bool is_known(std::uint32_t cluster) const { return next_.known[cluster] != 0; }
  // Of a cluster that is known.
  void remember(std::uint32_t cell) { next_.inside[cell] = true; }
  template <class Counts>
  void remember_if(const CellCluster& cluster, const Counts& counts) {
    for (std::uint32_t cell = cluster.begin; cell < cluster.end; ++cell)
      next_.inside[cell] = counts(cell);
  }
  // When all is remembered: it replaces what was.
  void turn() {
    std::swap(last_, next_);
    next_.clear();
  }

 private:
  // Of a cluster, those of its shares.
  struct Rows {
    std::uint32_t cluster, begin, end;
  };
  // Clusters that are not known cost nothing: most of a tool, mostly.
  struct Memory {
    Memory(std::size_t cells, std::size_t clusters)
        : inside(cells), feet(clusters), known(clusters) {
      remembered.reserve(clusters);
    }
    void clear() {
      for (const Rows& rows : remembered) {
        std::fill(inside.begin() + rows.begin, inside.begin() + rows.end, false);
        known[rows.cluster] = false;
      }
      remembered.clear();
    }
    std::vector<char> inside;  // of each share
    std::vector<Vec3> feet;    // of each cluster
    std::vector<char> known;
    std::vector<Rows> remembered;  // of the clusters that are known
  };
  Memory last_, next_;
  TangentPlane touched_;
};

}  // namespace vpm
