#include <vpm/tool.h>

#include "libvpm/api/handle_access.h"
#include "libvpm/haptics/virtual_coupling.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

Tool Tool::read(const std::string& path) {
  return HandleAccess::make<Tool>(read_tool_model(path));
}

void Tool::write(const std::string& path) const {
  write_tool_model(path, HandleAccess::held(*this));
}

double Tool::volume() const {
  return HandleAccess::held(*this).volume;
}

Vec3 Tool::center_of_mass() const {
  return HandleAccess::held(*this).center_of_mass;
}

double Tool::radius() const {
  return HandleAccess::held(*this).radius;
}

double Tool::gyration() const {
  return radius_of_gyration(HandleAccess::held(*this));
}

std::vector<Sphere> Tool::spheres() const {
  return HandleAccess::held(*this).spheres;
}

std::vector<ToolLevel> Tool::levels() const {
  const ToolModel& model = HandleAccess::held(*this);
  std::vector<ToolLevel> levels;
  for (std::size_t k = 0; k < model.levels.size(); ++k) {
    ToolLevel level{model.levels[k].sphere_count, std::nullopt, std::nullopt};
    if (k < model.calibration.size()) {
      level.mean_error = model.calibration[k].mean;
      level.worst_error = model.calibration[k].worst;
    }
    levels.push_back(level);
  }
  return levels;
}

}  // namespace vpm
