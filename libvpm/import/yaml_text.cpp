#include <yaml-cpp/yaml.h>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/import/intrinsics_file.h"

namespace vpm {
namespace {

constexpr int kDeepest = 16;  // levels of nesting; calibrations have three

nlohmann::json json_of(const YAML::Node& node, int depth) {
  if (depth > kDeepest) refuse("it is nested too deeply");
  if (node.IsSequence()) {
    nlohmann::json list = nlohmann::json::array();
    for (const YAML::Node& item : node) list.push_back(json_of(item, depth + 1));
    return list;
  }
  if (node.IsMap()) {
    nlohmann::json object = nlohmann::json::object();
    for (const auto& entry : node)
      if (entry.first.IsScalar()) object[entry.first.Scalar()] = json_of(entry.second, depth + 1);
    return object;
  }
  if (!node.IsScalar()) return nullptr;
  const std::optional<double> number = file::to_number(node.Scalar());
  return number ? nlohmann::json(*number) : nlohmann::json(node.Scalar());
}

}  // namespace

nlohmann::json parse_yaml(std::string_view text, const std::string& name) {
  std::string document(text);
  if (document.starts_with("%YAML:"))
    document.erase(0, document.find('\n'));  // OpenCV's first line, not YAML's own
  try {
    return json_of(YAML::Load(document), 0);
  } catch (const Error& fault) {
    refuse(fault.problem(), name);
  } catch (const std::exception& fault) {
    refuse(std::string("not YAML: ") + file::shown(fault.what(), 120), name);
  }
}

}  // namespace vpm
