// The second step of the refined measure where a camera has seen the surface: what is behind it, no
// further than the tool's reach, is inside. Beyond, the plane of the nearest cut share decides, or
// the memory of poses before.
#pragma once

#include "libvpm/core/parallel_region.h"
#include "libvpm/query/cut_shares.h"
#include "libvpm/query/passage.h"
#include "libvpm/query/pose_memory.h"

namespace vpm {

template <class Surface>
class SeenShares {
 public:
  SeenShares(ToolReach reach, const SpatialLevel& level, const Surface& surface,
             const Pose& to_surface, const CutShares& cut, ShareStates& states)
      : reach_(reach),
        level_(level),
        surface_(surface),
        to_surface_(to_surface),
        cut_(cut),
        states_(states) {}

  void run(const ParallelRegion&) {
    std::transform(
        states_.cells.begin(), states_.cells.end(), states_.passages.begin(), [](Cell cell) {
          return cell == Cell::free || cell == Cell::cut ? Passage::closed : Passage::taken;
        });
  }

  // Where the surface passes through no share: those stay inside that were, or were cut, as long as
  // they are behind the same surface.
  void run_from(PoseMemory& memory, const Pose& to_world) {
    memory_ = &memory;
    for (std::uint32_t i = 0; i < level_.size(); ++i) {
      if (!memory.was_inside(i)) continue;
      if (stays(i, memory, to_world))
        any_stays_ = true;
      else
        memory.forget(i);
    }
  }

  // Whether a place of a share is inside, though far behind the surface.
  bool vouches_for(std::uint32_t row, Vec3 x, Vec3 foot) const {
    return cut_.are_none() ? has_stayed(row)
                           : cut_.nearest_to(row).vouches_for(x, foot, reach_.length);
  }

  // Whether a share that counts is one to be remembered: not if all that speaks for it is that
  // something hides it.
  bool is_sure(std::uint32_t row) const {
    if (!cut_.are_none() || has_stayed(row)) return true;
    return any_stays_ && !is_hidden_share(squared_gap(surface_.read(center(row))), reach_.length);
  }

 private:
  Vec3 center(std::uint32_t row) const { return to_surface_ * level_.cell(row).center; }
  bool stays(std::uint32_t row, const PoseMemory& memory, const Pose& to_world) const {
    if (states_.cells[row] == Cell::free) return false;
    const Reading reading = surface_.read(center(row));
    return reading.known &&
           memory.is_near(level_.root(row), to_world * reading.foot, reach_.length);
  }
  bool has_stayed(std::uint32_t row) const {
    return memory_ != nullptr && memory_->was_inside(row);
  }

  ToolReach reach_;
  const SpatialLevel& level_;
  const Surface& surface_;
  const Pose& to_surface_;
  const CutShares& cut_;
  ShareStates& states_;
  const PoseMemory* memory_ = nullptr;  // of a tool that nothing cuts
  bool any_stays_ = false;
};

}  // namespace vpm
