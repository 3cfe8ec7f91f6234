#pragma once

#include "libvpm/backend/cuda/cell_notes.h"
#include "libvpm/backend/cuda/cell_tasks.h"
#include "libvpm/device/cuda/device_array.h"

namespace vpm::cuda {

// Holds the device memory of a number of teams, of one or more blocks each.
class RefinedMemory {
 public:
  RefinedMemory(const TeamRoom& room, std::size_t teams, std::size_t blocks, unsigned threads)
      : words_(2 * room.cells * teams),
        points_(2 * room.cells * teams),
        sums_(2 * room.cells * teams),
        planes_(2 * room.cells * teams),
        gaps_(room.cells * teams),
        parents_((room.cells + 1) * teams),
        cut_(room.cells * teams),
        far_(room.pieces * teams),
        flats_(2 * TaskLists::kTasks * blocks),
        planar_clusters_(threads * blocks) {
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
            planar_clusters_.get()};
  }

  // Returns the size of the memory of a team of one block, in bytes.
  static std::size_t bytes_of_team(const TeamRoom& room) {
    constexpr std::size_t kOfCell =
        2 * (2 * sizeof(std::uint32_t) + sizeof(ToolSum) + sizeof(ContactPlane)) + sizeof(double) +
        2 * sizeof(std::uint32_t);
    return room.cells * kOfCell + room.pieces * sizeof(FarPiece) +
           2 * TaskLists::kTasks * sizeof(FlatBlock) + kBatchThreads * sizeof(PlanarCluster);
  }

 private:
  DeviceArray<std::uint32_t> words_, points_;
  DeviceArray<ToolSum> sums_;
  DeviceArray<ContactPlane> planes_;
  DeviceArray<double> gaps_;
  DeviceArray<std::uint32_t> parents_, cut_;
  DeviceArray<FarPiece> far_;
  DeviceArray<FlatBlock> flats_;
  DeviceArray<PlanarCluster> planar_clusters_;
};

}  // namespace vpm::cuda
