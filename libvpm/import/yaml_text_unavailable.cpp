#include "libvpm/core/error.h"
#include "libvpm/import/yaml_text.h"

namespace vpm {

nlohmann::json parse_yaml(std::string_view, const std::string& name) {
  throw Error(ErrorKind::unavailable, "this build reads no YAML", name,
              "build it where yaml-cpp is installed, or give the numbers");
}

}  // namespace vpm
