// Finishes a query where a camera has seen the surface. The first step has added what is behind it
// by no more than the tool's radius; pieces further behind need the support of cut cells' planes.
#pragma once

#include "libvpm/backend/cuda/cut_cells.h"
#include "libvpm/backend/cuda/noted_cells.h"

namespace vpm::cuda {

template <class Team>
class CameraVisibility {
 public:
  using Shared = NotedList;  // memory of a block

  __device__ CameraVisibility(const LevelView& level, const Pose& to_surface,
                              const RefinedSpace& space, unsigned turn, RefinedCounters& counters,
                              Team& team, Shared& shared, bool counts_points)
      : notes_(space.notes[turn % 2]),
        counters_(counters),
        team_(team),
        noted_(level, notes_, team, shared),
        cut_(level, to_surface, space, notes_, counters, team),
        counts_points_(counts_points) {}

  // True if the first step has left `far` pieces, or points are to be counted.
  __device__ static bool has_more(unsigned far, bool counts_points) {
    return counts_points || far > 0;
  }
  // Returns what this thread adds to the first step's result. Call from all threads of the team.
  __device__ RawResult run() {
    RawResult result;
    const unsigned far = read_for_block(counters_).far;
    if (far > 0) {
      cut_.list();
      team_.sync();
      cut_.add_far(
          far, [](std::uint32_t) { return true; },
          [&](std::uint32_t i, const ToolSum& sum) {
            result.sum.add(sum);
            if (sum.volume.value != 0)
              count_cell(atomicOr(&notes_.words[i], cell_bit::counted), cell_bit::counted, result);
          });
    }
    if (counts_points_) {
      noted_.for_each([&](std::uint32_t i, std::uint32_t word) {
        if ((word & cell_bit::counts_points) != 0) result.points += notes_.points[i];
      });
    }
    return result;
  }

 private:
  const CellNotes& notes_;
  RefinedCounters& counters_;
  Team& team_;
  NotedCells<Team> noted_;
  CutCells<Team> cut_;
  bool counts_points_;
};

}  // namespace vpm::cuda
