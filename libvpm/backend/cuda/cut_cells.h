// Lists the cells that the surface cuts, whose planes support pieces far behind it.
#pragma once

#include "libvpm/backend/cuda/cell_notes.h"

namespace vpm::cuda {

template <class Team>
class CutCells {
 public:
  __device__ CutCells(const LevelView& level, const Pose& to_surface, const RefinedSpace& space,
                      const CellNotes& notes, RefinedCounters& counters, const Team& team)
      : level_(level),
        to_surface_(to_surface),
        space_(space),
        notes_(notes),
        counters_(counters),
        team_(team) {}

  // Lists the cut cells. Synchronise the team before calling other members.
  __device__ __noinline__ void list() {
    for (std::uint32_t i = team_.thread(); i < level_.count; i += team_.threads()) {
      if ((notes_.words[i] & cell_bit::cut) != 0) space_.cut[atomicAdd(&counters_.cut, 1U)] = i;
    }
  }
  __device__ CutCell at(std::uint32_t cut) const {
    return {notes_.planes[cut], to_surface_ * level_.centers[cut], level_.reach[cut]};
  }
  // Returns the nearest cut cell, or level.count if there is none; ties go to the smaller index.
  // Call from all lanes of a subwarp.
  __device__ std::uint32_t nearest_to(const Subwarp& subwarp, std::uint32_t i) const;

  // Adds the far pieces that count. Asks may_count(cell) for uncut cells; one thread calls
  // add(cell, sum).
  template <class MayCount, class Add>
  __device__ __noinline__ void add_far(unsigned count, const MayCount& may_count,
                                       const Add& add) const {
    const Subwarp warp(32);
    if (read(counters_.cut) == 0) return;
    for (unsigned k = team_.thread() / 32; k < count; k += team_.threads() / 32) {
      const FarPiece& far = space_.far[k];
      const std::uint32_t i = far.cell, word = notes_.words[i];
      const bool cut = (word & cell_bit::cut) != 0;
      if (!cut && !may_count(i)) continue;
      const std::uint32_t by = cut ? i : nearest_to(warp, i);
      if (by < level_.count && warp.leads() &&
          at(by).supports(far.at, far.foot, level_.tool_reach.length))
        add(i, far.sum);
    }
  }

 private:
  const LevelView& level_;
  const Pose& to_surface_;
  const RefinedSpace& space_;
  const CellNotes& notes_;
  RefinedCounters& counters_;
  const Team& team_;
};

template <class Team>
__device__ std::uint32_t CutCells<Team>::nearest_to(const Subwarp& subwarp, std::uint32_t i) const {
  const Vec3 from = level_.spheres[i].center;
  double best_squared = HUGE_VAL;
  std::uint32_t best = level_.count;
  const auto take = [&](double squared, std::uint32_t j) {
    if (!is_nearer_cut(squared, j, best_squared, best)) return;
    best_squared = squared;
    best = j;
  };
  const unsigned count = read(counters_.cut);
  for (unsigned k = subwarp.lane; k < count; k += subwarp.width) {
    const std::uint32_t j = space_.cut[k];
    take(squared_norm(level_.spheres[j].center - from), j);
  }
  for (unsigned other = subwarp.width / 2; other > 0; other /= 2) {
    const double squared = __shfl_xor_sync(subwarp.mask, best_squared, other, subwarp.width);
    take(squared, __shfl_xor_sync(subwarp.mask, best, other, subwarp.width));
  }
  return best;
}

}  // namespace vpm::cuda
