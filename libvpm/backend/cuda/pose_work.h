// Bundles what the threads that measure cells know of their pose.
#pragma once

#include "libvpm/backend/cuda/cell_notes.h"

namespace vpm::cuda {

template <class Surface>
struct PoseWork {
  const LevelView& level;
  const Surface& surface;
  const Pose& to_surface;
  const RefinedSpace& space;
  const CellNotes& notes;  // the pose's notes in `space`
  RefinedCounters& counters;
  BlockRange part;

  __device__ PoseWork(const LevelView& of_level, const Surface& of_surface, const Pose& pose,
                      const RefinedSpace& of_space, unsigned turn, RefinedCounters& of_counters,
                      BlockRange of_part)
      : level(of_level),
        surface(of_surface),
        to_surface(pose),
        space(of_space),
        notes(of_space.notes[turn % 2]),
        counters(of_counters),
        part(of_part) {}

  __device__ CellMeasure<Surface> measure_of(const CellView& view) const {
    return {surface, to_surface, level.tool_reach, view};
  }

  // Adds a piece that is inside or cut; lists a far one. `normal` is the way out of an uncut one.
  __device__ void add_inside(const CellMeasure<Surface>& measure, const ToolPiece& piece,
                             const typename CellMeasure<Surface>::PieceSample& sampled, Vec3 normal,
                             std::uint32_t cell, ToolSum& total) const {
    ToolSum sum;
    measure.add(piece, sampled, normal, surface, sum);
    if (!sampled.is_far) {
      total.add(sum);
      return;
    }
    // Assigns member by member, since nvcc would store the whole byte by byte.
    FarPiece& far = space.far[atomicAdd(&counters.far, 1U)];
    far.at = sampled.x;
    far.foot = sampled.on_surface.foot;
    far.sum = sum;
    far.cell = cell;
  }
};

}  // namespace vpm::cuda
