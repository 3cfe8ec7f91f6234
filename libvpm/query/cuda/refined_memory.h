#pragma once

#include "libvpm/device/cuda/device_array.h"
#include "libvpm/query/cuda/share_tasks.h"
#include "libvpm/query/cuda/shares.h"

namespace vpm::cuda {

// Memory of a number of teams, of one or more blocks each.
class RefinedMemory {
 public:
  RefinedMemory(const LevelView& level, std::size_t teams, std::size_t blocks, unsigned threads)
      : words_(2 * level.count * teams),
        points_(2 * level.count * teams),
        sums_(2 * level.count * teams),
        planes_(2 * level.count * teams),
        gaps_(level.count * teams),
        parents_((std::size_t{level.count} + 1) * teams),
        cut_(level.count * teams),
        far_(level.piece_count * teams),
        flats_(2 * TaskLists::kTasks * blocks),
        patches_(threads * blocks) {
    words_.clear();
    points_.clear();
    sums_.clear();
    planes_.clear();
  }

  RefinedSpace space() const {
    const std::size_t half = words_.size() / 2;
    return {{{words_.get(), points_.get(), sums_.get(), planes_.get()},
             {words_.get() + half, points_.get() + half, sums_.get() + half, planes_.get() + half}},
            gaps_.get(),
            parents_.get(),
            cut_.get(),
            far_.get(),
            flats_.get(),
            patches_.get()};
  }

  // Of a team of one block.
  static std::size_t bytes_of_team(const LevelView& level) {
    constexpr std::size_t kOfShare =
        2 * (2 * sizeof(std::uint32_t) + sizeof(ToolSum) + sizeof(ContactPlane)) + sizeof(double) +
        2 * sizeof(std::uint32_t);
    return level.count * kOfShare + level.piece_count * sizeof(FarPiece) +
           2 * TaskLists::kTasks * sizeof(FlatBlock) + kBatchThreads * sizeof(CrossingPlane);
  }

 private:
  DeviceArray<std::uint32_t> words_, points_;
  DeviceArray<ToolSum> sums_;
  DeviceArray<ContactPlane> planes_;
  DeviceArray<double> gaps_;
  DeviceArray<std::uint32_t> parents_, cut_;
  DeviceArray<FarPiece> far_;
  DeviceArray<FlatBlock> flats_;
  DeviceArray<CrossingPlane> patches_;
};

}  // namespace vpm::cuda
