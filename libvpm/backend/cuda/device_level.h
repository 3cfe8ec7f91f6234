// Holds a tool's level in the memory of a device: its block tasks in groups, and all that they
// need.
#pragma once

#include "libvpm/backend/cuda/views.h"
#include "libvpm/device/cuda/device_array.h"

namespace vpm::cuda {

class DeviceLevel {
 public:
  DeviceLevel(const ToolModel& tool, const Level& level, Shadows shadows);
  const LevelView& view() const { return view_; }

 private:
  void add_edges(const SphereGraph& graph);
  void add_tasks(const ToolModel& tool, const Level& level);

  DeviceMemory memory_;
  LevelView view_;
};

}  // namespace vpm::cuda
