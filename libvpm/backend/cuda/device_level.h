// Holds a tool's level in the memory of a device: its block tasks in groups, and all that they
// need.
#pragma once

#include <span>
#include <vector>

#include "libvpm/backend/cuda/views.h"
#include "libvpm/device/cuda/device_array.h"

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

// Returns a bounding radius of a level's spheres about the centre of mass, m.
double reach_of_spheres(const ToolModel& tool, const Level& level);

class DeviceLevel {
 public:
  DeviceLevel(const ToolModel& tool, const Level& level, OccludedSpace occluded)
      : DeviceLevel(tool, level, {tool.reach, occluded}, cluster_cells(tool, level)) {}
  const LevelView& view() const { return view_; }

 private:
  DeviceLevel(const ToolModel& tool, const Level& level, ToolReach reach,
              const CellClusters& clusters);

  DeviceArray<Sphere> spheres_;
  DeviceArray<Vec3> centers_;
  DeviceArray<double> reach_;
  DeviceArray<std::uint32_t> block_begin_, grid_begin_, grid_spheres_;
  DeviceArray<CellBlock> blocks_;
  DeviceArray<BlockMass> block_masses_, cell_masses_;
  DeviceArray<CellSample> samples_;
  DeviceArray<BlockTask> units_;
  DeviceArray<WarpTask> units_of_warps_;
  DeviceArray<TaskGroup> chunks_, chunks_of_warps_;
  DeviceArray<Edge> edges_;
  DeviceArray<std::uint32_t> edge_begin_;
  LevelView view_;
};

}  // namespace vpm::cuda
