// What a query finds of each share of a level: how the surface meets it, and whether the flood may
// pass it.
#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include "libvpm/backend/cpu/spatial_level.h"
#include "libvpm/measure/cell_measure.h"
#include "libvpm/measure/flood_state.h"

namespace vpm {

inline constexpr std::uint32_t kNoRow = UINT32_MAX;

// The first row from `begin` on that is not free, or `end`.
inline std::uint32_t next_busy(const std::vector<CellClass>& cells, std::uint32_t begin,
                               std::uint32_t end) {
  static_assert(static_cast<int>(CellClass::free) == 0);
  for (std::uint64_t many = 0; begin + sizeof many <= end; begin += sizeof many) {
    std::memcpy(&many, cells.data() + begin, sizeof many);
    if (many != 0) break;
  }
  while (begin < end && cells[begin] == CellClass::free) ++begin;
  return begin;
}

// Where one thread floods: the rows from `begin` to `end`.
struct FloodPart {
  struct Step {
    std::uint32_t from, to;
  };

  bool owns(std::uint32_t row) const { return row - begin < end - begin; }

  std::uint32_t begin = 0, end = 0;
  std::vector<std::uint32_t> front;  // taken, but not yet left
  std::vector<Step> leaving, left;   // to rows of other parts, in this round and in the last
  std::uint32_t last_cut = kNoRow;   // nearest to the row that was asked for last, of this run
};

// A cluster with shares that the surface cuts, which lie side by side in CellStates::cut.
struct CutCluster {
  Vec3 center;  // about the tool's centre of mass
  double reach;
  std::uint32_t begin, end;
};

// Calls visit(row) for the rows from `begin` to `end` in this state, ascending.
template <class State, class Visit>
void for_rows_in(State state, const std::vector<State>& states, std::size_t begin, std::size_t end,
                 const Visit& visit) {
  static_assert(sizeof(State) == 1);  // memchr looks at many at once
  while (begin < end) {
    const void* at = std::memchr(states.data() + begin, static_cast<int>(state), end - begin);
    if (at == nullptr) return;
    begin = static_cast<std::size_t>(static_cast<const State*>(at) - states.data());
    for (; begin < end && states[begin] == state; ++begin) visit(static_cast<std::uint32_t>(begin));
  }
}

struct CellStates {
  explicit CellStates(const SpatialLevel& level)
      : cells(level.size()),
        flood_states(level.size()),
        results(level.size()),
        squared_gaps(level.size()),
        planes(level.roots().size()),
        parts(1) {
    cut.reserve(level.size());
    cut_clusters.reserve(level.roots().size());
    parts[0].front.reserve(level.size());
  }

  void set(std::uint32_t row, CellClass cell, FloodState flood_state) {
    cells[row] = cell;
    flood_states[row] = flood_state;
  }
  // Of all rows of a cluster.
  void set(const CellCluster& cluster, CellClass cell, FloodState flood_state) {
    std::fill(cells.begin() + cluster.begin, cells.begin() + cluster.end, cell);
    std::fill(flood_states.begin() + cluster.begin, flood_states.begin() + cluster.end,
              flood_state);
  }

  // Notes the class of a cluster, or of a part of one, that is neither cut nor uniform.
  void set(const CellCluster& cluster, ClusterClass found) {
    switch (found) {
      case ClusterClass::no_surface:
        return set(cluster, CellClass::no_surface, FloodState::unknown);
      case ClusterClass::by_middle:
        return set(cluster, CellClass::no_surface, FloodState::middle);
      case ClusterClass::behind:
        return set(cluster, CellClass::whole, FloodState::unknown);
      case ClusterClass::behind_near:
        return set(cluster, CellClass::whole, FloodState::near);
      default:
        return set(cluster, CellClass::free, FloodState::closed);
    }
  }

  // Whether a row counts, when it is decided what is taken.
  bool counts(std::uint32_t row) const {
    return cells[row] == CellClass::cut ||
           (flood_states[row] == FloodState::reached && cells[row] != CellClass::free);
  }

  // Rows of the SpatialLevel.
  std::vector<CellClass> cells;
  std::vector<FloodState> flood_states;
  std::vector<CellResult> results;   // of what is cut or partial
  std::vector<double> squared_gaps;  // of the centre from the surface, where asked; m^2
  // Of each root that is a patch; of one behind the surface, the normal only.
  std::vector<ClipPlane> planes;
  std::vector<std::uint32_t> cut;  // shares that the surface cuts, ascending
  std::vector<CutCluster> cut_clusters;
  std::vector<std::uint32_t> work;  // of the flood, estimated, in chunks of rows
  // As many as ever flooded side by side; those from `part_count` on are not in use.
  std::vector<FloodPart> parts;
  std::size_t part_count = 1;
};

// Notes a uniform cluster: all its cells are pushed along one normal. `middle` is the surface
// sample at its centre.
template <class Surface>
void push_cluster(const Surface& surface, const Pose& to_surface, const CellCluster& cluster,
                  std::uint32_t root, const SurfaceSample& middle, CellStates& states) {
  states.set(cluster, CellClass::uniform, FloodState::near);
  states.planes[root].normal =
      transpose(to_surface.rotation) * surface.closest_normal(to_surface * cluster.center, middle);
}

}  // namespace vpm
