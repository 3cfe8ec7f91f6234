// Remembers, over a coherent sequence of poses, which cells were inside or cut at the last pose,
// and behind which place of the surface each cluster of cells was.
//
// A tool that has passed wholly behind the surface is cut by nothing: a single pose cannot tell
// what is inside from what an object in front hides. With the memory a cell stays inside as long as
// it is behind the same surface: one within the tool radius of where its cluster was
// (measure/README.md, "Coherent poses").
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/scene/body.h"

namespace vpm {

class PoseMemory {
 public:
  PoseMemory(std::size_t cells, std::size_t clusters)
      : last_(cells, clusters), next_(cells, clusters) {}

  bool was_inside(std::uint32_t cell) const { return last_.inside[cell] != 0; }
  // Calls visit(cell) for each cell that was inside.
  template <class Visit>
  void for_cells(const Visit& visit) const {
    for (const Rows& rows : last_.remembered) {
      for (std::uint32_t cell = rows.begin; cell < rows.end; ++cell)
        if (was_inside(cell)) visit(cell);
    }
  }
  bool is_near(std::uint32_t cluster, Vec3 foot, double tool_radius) const {
    return last_.known[cluster] &&
           squared_norm(foot - last_.feet[cluster]) <= tool_radius * tool_radius;
  }
  // Returns the plane in which the surface last cut the tool, world coordinates.
  const TangentPlane& touched() const { return touched_; }
  void touch(const TangentPlane& plane) { touched_ = plane; }
  void forget(std::uint32_t cell) { last_.inside[cell] = false; }
  void forget() { last_.clear(); }

  // Makes a cluster known; a cell of it is behind the place `foot` of the surface, world frame.
  void remember(std::uint32_t index, const CellCluster& cluster, Vec3 foot) {
    next_.feet[index] = foot;
    next_.known[index] = true;
    next_.remembered.push_back({index, cluster.begin, cluster.end});
  }
  bool is_known(std::uint32_t cluster) const { return next_.known[cluster] != 0; }
  // Remembers a cell of a known cluster.
  void remember(std::uint32_t cell) { next_.inside[cell] = true; }
  template <class Counts>
  void remember_if(const CellCluster& cluster, const Counts& counts) {
    for (std::uint32_t cell = cluster.begin; cell < cluster.end; ++cell)
      next_.inside[cell] = counts(cell);
  }
  // Replaces the memory of the last pose with what was remembered since.
  void turn() {
    std::swap(last_, next_);
    next_.clear();
  }

 private:
  // The cells [begin, end) of a cluster.
  struct Rows {
    std::uint32_t cluster, begin, end;
  };
  // What is remembered of one pose. Clearing it takes no time for clusters that are not known.
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
    std::vector<char> inside;  // for each cell
    std::vector<Vec3> feet;    // for each cluster, world coordinates
    std::vector<char> known;
    std::vector<Rows> remembered;  // the clusters that are known
  };
  Memory last_, next_;
  TangentPlane touched_;
};

}  // namespace vpm
