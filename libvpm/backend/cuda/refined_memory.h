#pragma once

#include "libvpm/backend/cuda/share_tasks.h"
#include "libvpm/backend/cuda/shares.h"
#include "libvpm/device/cuda/device_array.h"

namespace vpm::cuda {

// Memory of a number of teams, of one or more blocks each.
class RefinedMemory {
 public:
  RefinedMemory(const TeamRoom& room, std::size_t teams, std::size_t blocks, unsigned threads)
      : words_(2 * room.shares * teams),
        points_(2 * room.shares * teams),
        sums_(2 * room.shares * teams),
        planes_(2 * room.shares * teams),
        gaps_(room.shares * teams),
        parents_((room.shares + 1) * teams),
        cut_(room.shares * teams),
        far_(room.pieces * teams),
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
  static std::size_t bytes_of_team(const TeamRoom& room) {
    constexpr std::size_t kOfShare =
        2 * (2 * sizeof(std::uint32_t) + sizeof(ToolSum) + sizeof(ContactPlane)) + sizeof(double) +
        2 * sizeof(std::uint32_t);
    return room.shares * kOfShare + room.pieces * sizeof(FarPiece) +
           2 * TaskLists::kTasks * sizeof(FlatBlock) + kBatchThreads * sizeof(CrossedPatch);
  }

 private:
  DeviceArray<std::uint32_t> words_, points_;
  DeviceArray<ToolSum> sums_;
  DeviceArray<ContactPlane> planes_;
  DeviceArray<double> gaps_;
  DeviceArray<std::uint32_t> parents_, cut_;
  DeviceArray<FarPiece> far_;
  DeviceArray<FlatBlock> flats_;
  DeviceArray<CrossedPatch> patches_;
};

}  // namespace vpm::cuda
