#include "tools/common/solid_argument.h"

#include <vpm/pose.h>

#include <filesystem>
#include <system_error>

#include "tools/common/error_text.h"
#include "tools/common/mesh_tool.h"

namespace vpm::tools {

SolidArgument solid_from_text(const std::string& text, const std::string& option) {
  std::error_code fault;
  const std::size_t at = text.rfind('@');
  if (at == text.npos || std::filesystem::exists(text, fault)) return {text, {}};
  return {text.substr(0, at), naming(option, [&] { return pose_from_text(text.substr(at + 1)); })};
}

SolidBody solid_of_file(const Program& program, const std::string& name, bool with_force) {
  if (is_mesh_file(name)) return solid_of_mesh(program, name, with_force);
  const Tool model = Tool::read(name);
  return naming(name, [&] { return SolidBody(model, with_force); });
}

}  // namespace vpm::tools
