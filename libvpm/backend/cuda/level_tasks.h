// Makes the block tasks of a level and their groups for a device.
#pragma once

#include <span>
#include <vector>

#include "libvpm/backend/cuda/views.h"

namespace vpm::cuda {

template <class SomeTask>
struct GroupedTasks {
  std::vector<SomeTask> units;
  std::vector<TaskGroup> chunks;
};

class LevelTasks {
 public:
  LevelTasks(const ToolModel& tool, const Level& level, const CellClusters& clusters);

  const std::vector<BlockMass>& block_masses() const { return block_masses_; }
  // Returns the tasks cluster by cluster.
  GroupedTasks<BlockTask> chunked() const;
  // Returns the tasks for WarpTaskGroups, and in `wide_count` the number of groups of wide tasks.
  GroupedTasks<WarpTask> chunked_for_warps(std::uint32_t& wide_count) const;

 private:
  void add_units(std::uint32_t cell, std::vector<WarpTask>& units) const;
  std::vector<WarpTask> units_of(const CellCluster& cluster) const;

  const ToolModel& tool_;
  const Level& level_;
  const CellClusters& clusters_;
  std::vector<BlockMass> block_masses_;
};

}  // namespace vpm::cuda
