#include "libvpm/include/vpm/tool.h"

#include "libvpm/haptics/virtual_coupling.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

Tool Tool::read(const std::string& path) {
  return Tool(std::make_shared<const ToolModel>(read_tool_model(path)));
}

void Tool::write(const std::string& path) const {
  write_tool_model(path, *model_);
}

double Tool::volume() const {
  return model_->volume;
}

Vec3 Tool::center_of_mass() const {
  return model_->center_of_mass;
}

double Tool::bounding_radius() const {
  return model_->reach;
}

double Tool::gyration() const {
  return radius_of_gyration(*model_);
}

std::vector<Sphere> Tool::spheres() const {
  return model_->spheres;
}

std::vector<ToolLevel> Tool::levels() const {
  std::vector<ToolLevel> levels;
  for (std::size_t k = 0; k < model_->levels.size(); ++k) {
    ToolLevel level{model_->levels[k].sphere_count, std::nullopt, std::nullopt};
    if (k < model_->calibration.size()) {
      level.mean_error = model_->calibration[k].mean;
      level.worst_error = model_->calibration[k].worst;
    }
    levels.push_back(level);
  }
  return levels;
}

}  // namespace vpm
