// Holds the state of each cell of a level during a query (its class and its flood state), lists the
// cells that the surface cuts, and finds the nearest one, whose plane supports far places.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <vector>

#include "libvpm/backend/cpu/spatial_level.h"
#include "libvpm/measure/cell_measure.h"
#include "libvpm/measure/flood_rules.h"

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
  double radius;
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
        far(level.most_pieces()),
        planes(level.roots().size()),
        cluster_points(level.roots().size()),
        parts(1) {
    cut.reserve(level.size());
    cut_clusters.reserve(level.roots().size());
    uniform.reserve(level.roots().size());
    open_groups.reserve(level.groups().size());
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

  void set_uniform(const CellCluster& cluster) {
    set(cluster, CellClass::uniform, flood_state_of(ClusterClass::uniform));
  }
  // True if a row is in a cluster for which set_uniform() was called last: cells of a cut cluster
  // are in another flood state.
  bool is_uniform(std::uint32_t row) const {
    return cells[row] == CellClass::uniform &&
           flood_states[row] == flood_state_of(ClusterClass::uniform);
  }
  // Notes the class of a cluster, or of a part of one, that is neither ambiguous nor planar.
  void set(const CellCluster& cluster, ClusterClass found) {
    set(cluster, class_on_side(side_of_cells(found)), flood_state_of(found));
  }
  // Notes the side of a cell that is not ambiguous.
  void set(std::uint32_t row, Side side) {
    set(row, class_on_side(side), side == Side::free ? FloodState::closed : FloodState::unknown);
  }

  // True if a row that is not cut was found to be inside, as far as it is behind the surface.
  bool is_taken(std::uint32_t row) const {
    return flood_states[row] == FloodState::reached || flood_states[row] == FloodState::enclosed;
  }
  // True if a row counts. Valid once it is decided what is taken.
  bool counts(std::uint32_t row) const {
    return cells[row] == CellClass::cut || (is_taken(row) && cells[row] != CellClass::free);
  }

  // Holds one entry per row of the SpatialLevel in each vector, unless said otherwise.
  std::vector<CellClass> cells;
  std::vector<FloodState> flood_states;
  std::vector<CellResult> results;  // valid for cut and partial cells
  // The point nearest to the centre, or kNoPoint where nobody asked; for bodies that search.
  std::vector<std::uint32_t> points;
  std::vector<double> squared_gaps;  // gap of the centre, valid where asked, m^2
  std::vector<PieceIndex> far;       // far pieces, from SpatialLevel::first_piece() of each cell on
  // Holds the planes of clusters by root: of cut ones, and only the normals of uniform ones.
  std::vector<ClipPlane> planes;
  // The point of the class of each cluster's ball, by root, for bodies that tell what is unknown.
  std::vector<std::uint32_t> cluster_points;
  std::vector<std::uint32_t> open_groups;  // not known to be free before they are classified
  std::vector<std::uint32_t> uniform;      // roots of clusters to be pushed along one normal
  std::vector<std::uint32_t> cut;          // rows of cut cells, ascending
  std::vector<CutCluster> cut_clusters;
  std::vector<std::uint32_t> work;  // the flood's estimated work, per kRowsOfChunk rows
  UnseenSum unseen;                 // of the pose, over all cells
  // Keeps as many parts as were ever used; the first `part_count` are in use.
  std::vector<FloodPart> parts;
  std::size_t part_count = 1;
  bool keeps_sums = false;  // in `results`, of each row that counts
};

// Bundles what the steps of a query know of its pose.
template <class Surface>
struct PoseWork {
  ToolRadius tool_radius;
  const SpatialLevel& level;
  const Surface& surface;
  const Pose& to_surface;  // maps coordinates about the tool's centre of mass
  CellStates& states;

  // Returns the centre of a cell's sphere in the surface's frame.
  Vec3 center(std::uint32_t row) const { return to_surface * level.cell(row).center; }
  CellMeasure<Surface> measure_of(const CellView& cell) const {
    return {surface, to_surface, tool_radius, cell};
  }
  // Notes a uniform cluster: all its cells are pushed along one normal. `middle` is the surface
  // sample at its centre.
  void push(const CellCluster& cluster, std::uint32_t root, const SurfaceSample& middle) const {
    states.set_uniform(cluster);
    set_direction(root, surface.closest_normal(to_surface * cluster.center, middle));
  }
  // Sets the direction, surface frame, along which a uniform cluster is pushed.
  void set_direction(std::uint32_t root, Vec3 normal) const {
    states.planes[root].normal = transpose(to_surface.rotation) * normal;
  }
  // Lists the clusters that the classifier has found uniform.
  void list_uniform() const {
    states.uniform.clear();
    for (const std::uint32_t open : states.open_groups) {
      const CellGroup& group = level.groups()[open];
      for (std::uint32_t root = group.begin; root < group.end; ++root)
        if (states.is_uniform(level.cluster(root).begin)) states.uniform.push_back(root);
    }
  }
};

// Lists the cells that the surface cuts and finds the nearest one.
class CutCells {
 public:
  CutCells(const ToolModel& tool, const SpatialLevel& level, const Pose& to_surface,
           CellStates& states)
      : tool_(tool),
        level_(level),
        to_surface_(to_surface),
        states_(states),
        rounding_(kUlps * std::numeric_limits<double>::epsilon() * norm(tool.center_of_mass)) {}

  // Lists the cut cells. All cells must be classified.
  void list() {
    states_.cut.clear();
    for_rows_in(CellClass::cut, states_.cells, 0, level_.size(),
                [&](std::uint32_t i) { states_.cut.push_back(i); });
    states_.cut_clusters.clear();
    std::uint32_t last = UINT32_MAX;
    for (std::uint32_t k = 0; k < states_.cut.size(); ++k) {
      const std::uint32_t root = level_.root(states_.cut[k]);
      if (root != last) {
        const CellCluster& ball = level_.cluster(root);
        states_.cut_clusters.push_back({ball.center, ball.radius, k, k});
      }
      states_.cut_clusters.back().end = k + 1;
      last = root;
    }
  }
  bool are_none() const { return states_.cut.empty(); }

  CutCell at(std::uint32_t cut) const {
    return {states_.results[cut].plane, to_surface_ * level_.cell(cut).center,
            level_.cell_radius(cut)};
  }
  // Returns the cut cell whose sphere's centre is nearest; ties go to the smaller sphere index.
  // Requires one. `last` becomes the result's row, and is a hint before: the last result, or
  // kNoRow.
  CutCell nearest_to(std::uint32_t row, std::uint32_t& last) const {
    const Vec3 from = level_.cell(row).center;
    Nearest nearest(tool_.spheres[level_.sphere(row)].center);
    consider(last != kNoRow ? last : states_.cut.front(), nearest);
    for (const CutCluster& cluster : states_.cut_clusters) {
      const double bound = kRounding * (std::sqrt(nearest.squared) + cluster.radius) + rounding_;
      if (squared_norm(cluster.center - from) > bound * bound) continue;
      for (std::uint32_t k = cluster.begin; k < cluster.end; ++k) consider(states_.cut[k], nearest);
    }
    last = nearest.row;
    return at(last);
  }

  // Returns a test of far places of one cell, true for a place x behind the surface's place `foot`,
  // surface frame, that is inside: by the plane of the nearest cut cell, found when first needed,
  // or, where nothing is cut, `where_nothing_is_cut`. `last` is as for nearest_to().
  auto support(std::uint32_t row, double tool_radius, bool where_nothing_is_cut,
               std::uint32_t& last) const {
    return [=, this, &last, nearest = std::optional<CutCell>()](Vec3 x, Vec3 foot) mutable {
      if (are_none()) return where_nothing_is_cut;
      if (!nearest) nearest = nearest_to(row, last);
      return nearest->supports(x, foot, tool_radius);
    };
  }

 private:
  static constexpr double kRounding = 1 + 1e-9;

  struct Nearest {
    Vec3 from;
    double squared = HUGE_VAL;
    std::uint32_t sphere = UINT32_MAX, row = 0;

    explicit Nearest(Vec3 center) : from(center) {}
  };
  void consider(std::uint32_t row, Nearest& nearest) const {
    const std::uint32_t sphere = level_.sphere(row);
    const double squared = squared_norm(tool_.spheres[sphere].center - nearest.from);
    if (!is_nearer_cut(squared, sphere, nearest.squared, nearest.sphere)) return;
    nearest.squared = squared;
    nearest.sphere = sphere;
    nearest.row = row;
  }
  const ToolModel& tool_;
  const SpatialLevel& level_;
  const Pose& to_surface_;
  CellStates& states_;
  // Bound of rounding, in units in the last place: spheres lie about the tool's origin, clusters
  // about its centre of mass.
  static constexpr double kUlps = 4;
  double rounding_;  // m
};

}  // namespace vpm
