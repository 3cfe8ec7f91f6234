// Lists the cells that the surface cuts and finds the nearest one, whose plane supports far places.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "libvpm/backend/cpu/cell_states.h"
#include "libvpm/measure/flood_rules.h"

namespace vpm {

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
        states_.cut_clusters.push_back({ball.center, ball.reach, k, k});
      }
      states_.cut_clusters.back().end = k + 1;
      last = root;
    }
  }
  bool are_none() const { return states_.cut.empty(); }

  CutCell at(std::uint32_t cut) const {
    return {states_.results[cut].plane, to_surface_ * level_.cell(cut).center, level_.reach(cut)};
  }
  // Returns the cut cell whose sphere's centre is nearest; ties go to the smaller sphere index.
  // Requires one. `last` becomes the result's row, and is a hint before: the last result, or
  // kNoRow.
  CutCell nearest_to(std::uint32_t row, std::uint32_t& last) const {
    const Vec3 from = level_.cell(row).center;
    Nearest nearest(tool_.spheres[level_.sphere(row)].center);
    consider(last != kNoRow ? last : states_.cut.front(), nearest);
    for (const CutCluster& cluster : states_.cut_clusters) {
      const double reach = kRounding * (std::sqrt(nearest.squared) + cluster.reach) + rounding_;
      if (squared_norm(cluster.center - from) > reach * reach) continue;
      for (std::uint32_t k = cluster.begin; k < cluster.end; ++k) consider(states_.cut[k], nearest);
    }
    last = nearest.row;
    return at(last);
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
  // Bounds rounding: spheres lie about the tool's origin, clusters about its centre of mass.
  static constexpr double kUlps = 4;
  double rounding_;  // m
};

// Decides whether far places of one cell are inside: by the plane of the nearest cut cell or, where
// nothing is cut, by `where_nothing_is_cut`.
class PlaneSupport {
 public:
  PlaneSupport(const CutCells& cut, std::uint32_t row, double reach, bool where_nothing_is_cut,
               std::uint32_t& last_cut)
      : cut_(cut),
        row_(row),
        reach_(reach),
        where_nothing_is_cut_(where_nothing_is_cut),
        last_cut_(last_cut) {}

  // True if a place x behind the surface's place `foot` is inside; surface frame.
  bool operator()(Vec3 x, Vec3 foot) {
    if (cut_.are_none()) return where_nothing_is_cut_;
    if (!nearest_) nearest_ = cut_.nearest_to(row_, last_cut_);
    return nearest_->supports(x, foot, reach_);
  }

 private:
  const CutCells& cut_;
  std::uint32_t row_;
  double reach_;
  bool where_nothing_is_cut_;
  std::uint32_t& last_cut_;
  std::optional<CutCell> nearest_;  // found when first needed
};

}  // namespace vpm
