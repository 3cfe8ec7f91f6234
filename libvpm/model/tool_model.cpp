#include "libvpm/model/tool_model.h"

#include "libvpm/core/error.h"

namespace vpm {

const Level& ToolModel::level(std::uint32_t sphere_count) const {
  if (levels.empty()) throw Error(ErrorKind::invalid_argument, "the tool model has no levels");
  if (sphere_count == 0) return levels.back();
  std::string there_are;
  for (const Level& level : levels) {
    if (level.sphere_count == sphere_count) return level;
    there_are += (there_are.empty() ? "" : ", ") + std::to_string(level.sphere_count);
  }
  throw Error(ErrorKind::invalid_argument, "the tool model has no level of " +
                                               std::to_string(sphere_count) + " spheres; it has " +
                                               there_are);
}

}  // namespace vpm
