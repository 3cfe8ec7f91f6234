// Holds the state of each cell of a level during a query: its class and its flood state.
#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include "libvpm/backend/cpu/spatial_level.h"
#include "libvpm/measure/cell_measure.h"
#include "libvpm/measure/flood_state.h"

namespace vpm {

inline constexpr std::uint32_t kNoRow = UINT32_MAX;

// Returns the first row from `begin` on that is not free, or `end`.
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

// Rows [begin, end), which one thread floods.
struct FloodPart {
  struct Step {
    std::uint32_t from, to;
  };

  bool owns(std::uint32_t row) const { return row - begin < end - begin; }

  std::uint32_t begin = 0, end = 0;
  std::vector<std::uint32_t> front;  // taken, neighbours not yet visited
  std::vector<Step> leaving, left;   // steps to other parts' rows, this round and last
  std::uint32_t last_cut = kNoRow;   // last result of CutCells::nearest_to() in this run
};

// Describes a cluster with cut cells, which are a range of CellStates::cut.
struct CutCluster {
  Vec3 center;  // about the tool's centre of mass
  double reach;
  std::uint32_t begin, end;
};

// Calls visit(row) for the rows in [begin, end) with this state, ascending.
template <class State, class Visit>
void for_rows_in(State state, const std::vector<State>& states, std::size_t begin, std::size_t end,
                 const Visit& visit) {
  static_assert(sizeof(State) == 1);  // for memchr
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

  // True if a row counts. Valid once it is decided what is taken.
  bool counts(std::uint32_t row) const {
    return cells[row] == CellClass::cut ||
           (flood_states[row] == FloodState::reached && cells[row] != CellClass::free);
  }

  // Holds one entry per row of the SpatialLevel in each vector, unless said otherwise.
  std::vector<CellClass> cells;
  std::vector<FloodState> flood_states;
  std::vector<CellResult> results;   // valid for cut and partial cells
  std::vector<double> squared_gaps;  // gap of the centre, valid where asked, m^2
  // Holds the planes of clusters by root: of cut ones, and only the normals of uniform ones.
  std::vector<ClipPlane> planes;
  std::vector<std::uint32_t> cut;  // rows of cut cells, ascending
  std::vector<CutCluster> cut_clusters;
  std::vector<std::uint32_t> work;  // the flood's estimated work, per kRowsOfChunk rows
  // Keeps as many parts as were ever used; the first `part_count` are in use.
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
