#include "libvpm/backend/cpu/measure_refined.h"

#include <algorithm>

namespace vpm {
RefinedMeasure::RefinedMeasure(const ToolModel& tool, const Level& level,
                               const QueryOptions& options)
    : tool_(tool), reach_(tool.reach, options.occluded), level_(tool, level), cells_(level_) {
  if (options.coherent) memory_.emplace(level_.size(), level_.roots().size());
}

Result RefinedMeasure::run(const PreparedCloud& cloud, const Pose& pose) {
  if (cloud.is_organised()) return run_on(cloud.depth_surface(), cloud.camera_to_world(), pose);
  constexpr double kPlaces = 1.25;  // in tool radii: holds most sampled places
  DiskSurface disks = cloud.disk_surface();
  disks.feet.enter_near(pose * tool_.center_of_mass - cloud.origin(), kPlaces * tool_.reach);
  return run_on(disks, Pose{{}, cloud.origin()}, pose);
}

void RefinedMeasure::read_states(std::vector<SphereState>& states) const {
  std::fill(states.begin(), states.end(), SphereState::outside);
  for (std::uint32_t i = 0; i < level_.size(); ++i) {
    if (cells_.counts(i))
      states[level_.sphere(i)] =
          cells_.cells[i] == CellClass::cut ? SphereState::boundary : SphereState::inside;
  }
}

}  // namespace vpm
