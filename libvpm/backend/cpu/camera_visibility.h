// Decides which cells are inside where a camera has seen the surface: those behind it within the
// tool's radius. Further behind, the nearest cut cell's plane or the pose memory decides.
#pragma once

#include <algorithm>

#include "libvpm/backend/cpu/cut_cells.h"
#include "libvpm/core/parallel.h"
#include "libvpm/measure/flood_rules.h"
#include "libvpm/temporal/pose_memory.h"

namespace vpm {

template <class Surface>
class CameraVisibility {
 public:
  CameraVisibility(ToolReach reach, const SpatialLevel& level, const Surface& surface,
                   const Pose& to_surface, const CutCells& cut, CellStates& states)
      : reach_(reach),
        level_(level),
        surface_(surface),
        to_surface_(to_surface),
        cut_(cut),
        states_(states) {}

  void run(const ParallelRegion&) {
    std::transform(states_.cells.begin(), states_.cells.end(), states_.flood_states.begin(),
                   [](CellClass cell) {
                     return cell == CellClass::free || cell == CellClass::cut ? FloodState::closed
                                                                              : FloodState::reached;
                   });
  }

  // Keeps cells inside that were inside or cut at the last pose, as long as they are behind the
  // same surface. For a pose at which the surface cuts no cell.
  void run_from(PoseMemory& memory, const Pose& to_world) {
    memory_ = &memory;
    memory.for_cells([&](std::uint32_t i) {
      if (stays(i, memory, to_world))
        any_stays_ = true;
      else
        memory.forget(i);
    });
  }

  PlaneSupport support(std::uint32_t row, std::uint32_t& last_cut) const {
    return {cut_, row, reach_.length, has_stayed(row), last_cut};
  }

  // Sets up which cells the next pose remembers. Cells that count only because something hides them
  // are left out: what hides them must be within the tool's radius before the mean plane of the
  // last cut cells, and where nothing is cut, near them, and some cell must have stayed.
  void begin_to_remember(const Pose& to_world, PoseMemory& memory) {
    to_world_ = to_world;
    if (!cut_.are_none()) memory.touch(mean_plane_of_cut());
    plane_ = memory.touched();
  }
  // True if one remembered cell makes its whole cluster remembered; else follows() decides.
  bool all_follow() const { return !cut_.are_none(); }
  bool follows(std::uint32_t row) const { return has_stayed(row); }
  // True if a cell behind the surface's place `foot`, world frame, may be remembered.
  bool is_sure(std::uint32_t row, Vec3 foot) const {
    if (has_stayed(row)) return true;
    if (plane_.distance(foot) > reach_.length) return false;
    const double squared = squared_norm(foot - to_world_ * center(row));
    return !cut_.are_none() || (any_stays_ && !is_hidden_cell(squared, reach_.length));
  }

 private:
  Vec3 center(std::uint32_t row) const { return to_surface_ * level_.cell(row).center; }
  bool stays(std::uint32_t row, const PoseMemory& memory, const Pose& to_world) const {
    if (states_.cells[row] == CellClass::free) return false;
    const SurfaceSample on_surface = surface_.sample(center(row));
    return on_surface.known &&
           memory.is_near(level_.root(row), to_world * on_surface.foot, reach_.length);
  }
  TangentPlane mean_plane_of_cut() const {
    Vec3 normal, foot;
    for (const std::uint32_t i : states_.cut) {
      const CutCell cut = cut_.at(i);
      normal += cut.plane.normals();
      foot += cut.center + cut.reach * cut.plane.mean_foot();
    }
    foot = 1 / static_cast<double>(states_.cut.size()) * foot;
    return {to_world_.rotation * normalized_or_zero(normal), to_world_ * foot};
  }
  bool has_stayed(std::uint32_t row) const {
    return memory_ != nullptr && memory_->was_inside(row);
  }

  ToolReach reach_;
  const SpatialLevel& level_;
  const Surface& surface_;
  const Pose& to_surface_;
  const CutCells& cut_;
  CellStates& states_;
  Pose to_world_;                       // maps the surface's frame to the world's
  TangentPlane plane_;                  // mean plane of the last cut cells, world frame
  const PoseMemory* memory_ = nullptr;  // set where nothing is cut
  bool any_stays_ = false;
};

}  // namespace vpm
