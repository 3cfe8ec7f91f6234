#include "tools/query/robot_joints.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libvpm/core/error.h"
#include "libvpm/file/json_text.h"
#include "libvpm/file/nearest_word.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"

namespace vpm::tools {
namespace {

using nlohmann::json;

constexpr const char* kForms =
    "write {\"joint\": 0.5, …}, or [0.5, …] with a value for each movable joint";

class LineReader {
 public:
  LineReader(const Robot& robot, std::set<std::string>& missing)
      : robot_(robot), missing_(missing) {
    for (const RobotJoint& joint : robot.joints) names_.push_back(joint.name);
  }

  Configuration read(std::string_view text, const std::string& where) const {
    json line;
    try {
      line = file::parse_json(text);
    } catch (const Error& fault) {
      refuse("it is " + fault.problem(), where, kForms);
    }
    if (!line.is_array() && !line.is_object())
      refuse("it is no object and no array", where, kForms);
    Configuration configuration = line.is_array() ? of_array(line, where) : of_object(line, where);
    try {
      link_poses(robot_, configuration.values);
    } catch (const Error& fault) {  // of a value that no joint can have
      refuse(fault.problem(), where, "values are in radians and metres");
    }
    return configuration;
  }

 private:
  static double number(const json& value, const std::string& what, const std::string& where) {
    if (!value.is_number()) refuse("the value of " + what + " is no number", where, kForms);
    return value.get<double>();
  }

  Configuration of_array(const json& line, const std::string& where) const {
    if (line.size() != robot_.movable.size()) {
      std::vector<std::string> order;
      for (const std::size_t joint : robot_.movable) order.push_back(names_[joint]);
      refuse("the number of values is " + std::to_string(line.size()) +
                 ", that of movable joints " + std::to_string(order.size()),
             where, "give one for each of " + file::listed(order));
    }
    Configuration configuration;
    for (std::size_t k = 0; k < line.size(); ++k)
      configuration.values.push_back(
          number(line[k], "joint '" + names_[robot_.movable[k]] + "'", where));
    return configuration;
  }

  Configuration of_object(const json& line, const std::string& where) const {
    Configuration configuration;
    for (const auto& [name, value] : line.items()) {
      if (std::ranges::count(names_, name) > 0) continue;
      if (name == "id") {
        configuration.id = value.dump();
        continue;
      }
      const std::string guess = file::guess_of_word(name, names_);
      refuse("the robot has no joint '" + file::shown(name) + "'", where,
             guess.empty() ? "its joints are " + file::listed(names_) : guess);
    }
    for (const std::size_t joint : robot_.movable) {
      const auto value = line.find(names_[joint]);
      if (value == line.end()) missing_.insert(names_[joint]);
      configuration.values.push_back(
          value == line.end() ? 0 : number(*value, "joint '" + names_[joint] + "'", where));
    }
    return configuration;
  }

  const Robot& robot_;
  std::set<std::string>& missing_;
  std::vector<std::string> names_;
};

}  // namespace

std::vector<Configuration> read_configurations(const std::string& path, const Robot& robot,
                                               std::set<std::string>& missing) {
  const std::string name = path == "-" ? "standard input" : path;
  const std::vector<std::byte> bytes = file::read_all(path);
  std::string_view rest = file::without_byte_order_mark(file::as_text(bytes));
  const LineReader reader(robot, missing);
  std::vector<Configuration> configurations;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.find_first_not_of(" \t\r") == line.npos) continue;
    configurations.push_back(reader.read(line, name + ", line " + std::to_string(number)));
  }
  if (configurations.empty()) refuse("there is no configuration", name, kForms);
  return configurations;
}

}  // namespace vpm::tools
