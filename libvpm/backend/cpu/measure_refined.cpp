#include "libvpm/backend/cpu/measure_refined.h"

#include <algorithm>

namespace vpm {
namespace {

// Searches in points begin near the tool.
template <class Surface>
void enter_near(Surface&, Vec3, double) {}
void enter_near(DiskSurface& disks, Vec3 center, double radius) {
  disks.feet.enter_near(center, radius);
}

}  // namespace

RefinedMeasure::RefinedMeasure(const ToolModel& tool, const Level& level,
                               const QueryOptions& options)
    : tool_(tool),
      tool_radius_(tool.radius, options.shadows),
      shared_level_(std::make_shared<const SpatialLevel>(tool, level)),
      level_(*shared_level_),
      cells_(level_),
      is_coherent_(options.coherent),
      tells_variance_(options.interval) {
  if (options.contacts == 0) return;
  contacts_.emplace(tool, level_);
  cells_.keeps_sums = true;
}

std::optional<BodySum> RefinedMeasure::run_until(Until until, const AnyBody& body, const Pose& pose,
                                                 std::size_t place) {
  constexpr double kPlaces = 1.25;  // in tool radii: holds most sampled places
  return body.visit([&](const auto& one) {
    auto surface = one.surface();
    const Pose& to_world = one.to_world();
    enter_near(surface, pose_in_body(to_world, pose, tool_.center_of_mass).translation,
               kPlaces * tool_.radius);
    return run_on_until(until, surface, to_world, pose, place);
  });
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
