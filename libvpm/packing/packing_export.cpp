#include "libvpm/packing/packing_export.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/view/sphere_files.h"

namespace vpm {

std::string digits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

double rounded_up(double value) {
  constexpr double kStep = 1e-9;  // relative; nine digits are as fine, or finer
  const double nearest = std::stod(digits(value));
  return nearest >= value ? nearest : std::stod(digits(value + kStep * std::abs(value)));
}

namespace {

// Returns x, y and z with `between` between them.
std::string coordinates(Vec3 p, const char* between) {
  return digits(p.x) + between + digits(p.y) + between + digits(p.z);
}

// Returns the name as a JSON string, which is valid YAML too. Invalid UTF-8 becomes U+FFFD.
std::string json_text(const std::string& name) {
  return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Returns the name escaped for XML attributes, whose readers turn plain tabs and ends of lines into
// blanks; invalid UTF-8 becomes U+FFFD. Throws as check_link does.
std::string xml_text(const std::string& name) {
  const std::string valid = nlohmann::json::parse(json_text(name)).get<std::string>();
  std::string text;
  for (std::size_t k = 0; k < valid.size(); ++k) {
    const char c = valid[k];
    const bool is_white = c == '\t' || c == '\n' || c == '\r';
    const std::string_view rest = std::string_view(valid).substr(k);
    if ((static_cast<unsigned char>(c) < ' ' && !is_white) || rest.starts_with("\xEF\xBF\xBE") ||
        rest.starts_with("\xEF\xBF\xBF")) {
      throw Error(ErrorKind::invalid_argument,
                  "the name '" + file::shown(name) + "' has a character that XML cannot express",
                  "link", "give another name");
    }
    if (is_white || c == '&' || c == '<' || c == '>' || c == '"') {
      text += "&#" + std::to_string(int{c}) + ";";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

ExportFormat export_format(const std::string& path) {
  const std::string name = file::in_lower_case(path);
  const auto ends = [&](const char* extension) { return name.ends_with(extension); };
  if (view::sphere_format(path)) return ExportFormat::spheres;
  if (ends(".json")) return ExportFormat::json;
  if (ends(".vtk")) return ExportFormat::vtk;
  if (ends(".yml") || ends(".yaml")) return ExportFormat::yml;
  if (ends(".xrdf")) return ExportFormat::xrdf;
  if (ends(".urdf")) return ExportFormat::urdf;
  if (ends(".srdf")) return ExportFormat::srdf;
  throw Error(
      ErrorKind::invalid_argument,
      "the name '" + path +
          "' must end with .csv, .json, .ply (.points.ply), .glb, .vtk, .yml (.yaml), .xrdf, "
          ".urdf or .srdf",
      "export");
}

bool names_links(ExportFormat format) {
  return format == ExportFormat::yml || format == ExportFormat::xrdf ||
         format == ExportFormat::urdf || format == ExportFormat::srdf;
}

void check_link(ExportFormat format, const std::string& link) {
  if (format == ExportFormat::urdf || format == ExportFormat::srdf) xml_text(link);
}

std::string packing_as_json(const std::vector<Sphere>& spheres) {
  nlohmann::json centers = nlohmann::json::array(), radii = nlohmann::json::array();
  for (const Sphere& s : spheres) {
    centers.push_back({s.center.x, s.center.y, s.center.z});
    radii.push_back(s.radius);
  }
  return nlohmann::json{{"centers", centers}, {"radii", radii}}.dump() + "\n";
}

std::string packing_as_vtk(const std::vector<Sphere>& spheres) {
  const std::string count = std::to_string(spheres.size());
  std::string text =
      "# vtk DataFile Version 3.0\nspheres of a packing\nASCII\nDATASET POLYDATA\nPOINTS " + count +
      " double\n";
  for (const Sphere& s : spheres) text += coordinates(s.center, " ") + '\n';
  text += "VERTICES " + count + ' ' + std::to_string(2 * spheres.size()) + '\n';
  for (std::size_t k = 0; k < spheres.size(); ++k) text += "1 " + std::to_string(k) + '\n';
  text += "POINT_DATA " + count + "\nSCALARS radius double 1\nLOOKUP_TABLE default\n";
  for (const Sphere& s : spheres) text += digits(s.radius) + '\n';
  return text;
}

namespace {

// Returns lines of YAML, indented by so many blanks, that map each link to its spheres. JSON
// strings are YAML strings.
std::string yaml_of(const RobotSpheres& robot, std::size_t blanks) {
  const std::string indent(blanks, ' ');
  std::string text;
  for (const auto& [link, spheres] : robot.links) {
    text += indent + json_text(link) + ":\n";
    for (const Sphere& s : spheres)
      text += indent + "  - \"center\": [" + coordinates(s.center, ", ") + "]\n" + indent +
              "    \"radius\": " + digits(s.radius) + '\n';
  }
  return text;
}

std::string robot_element(const RobotSpheres& robot) {
  return "<?xml version=\"1.0\"?>\n<robot name=\"" + xml_text(robot.robot) + "\">\n";
}

}  // namespace

std::string packing_as_yml(const RobotSpheres& robot) {
  return "collision_spheres:\n" + yaml_of(robot, 2);
}

std::string packing_as_xrdf(const RobotSpheres& robot) {
  const std::string name = json_text(robot.robot + "_spheres");
  return "format: \"xrdf\"\nformat_version: 1.0\ncollision:\n  geometry: " + name +
         "\nself_collision:\n  geometry: " + name + "\ngeometry:\n  " + name + ":\n    spheres:\n" +
         yaml_of(robot, 6);
}

std::string packing_as_urdf(const RobotSpheres& robot) {
  std::string text = robot_element(robot);
  for (const auto& [link, spheres] : robot.links) {
    text += "  <link name=\"" + xml_text(link) + "\">\n";
    for (const Sphere& s : spheres)
      text += "    <collision>\n      <origin xyz=\"" + coordinates(s.center, " ") +
              "\" rpy=\"0 0 0\"/>\n      <geometry><sphere radius=\"" + digits(s.radius) +
              "\"/></geometry>\n    </collision>\n";
    text += "  </link>\n";
  }
  return text + "</robot>\n";
}

std::string packing_as_srdf(const RobotSpheres& robot) {
  std::string text = robot_element(robot);
  for (const auto& [link, spheres] : robot.links) {
    text += "  <link_sphere_approximation link=\"" + xml_text(link) + "\">\n";
    for (const Sphere& s : spheres)
      text += "    <sphere center=\"" + coordinates(s.center, " ") + "\" radius=\"" +
              digits(s.radius) + "\"/>\n";
    text += "  </link_sphere_approximation>\n";
  }
  return text + "</robot>\n";
}

std::string robot_as_csv(const RobotSpheres& robot) {
  std::string text = "link,x,y,z,r\n";
  for (const auto& [link, spheres] : robot.links) {
    std::string name = "\"";
    for (const char c : link) name += c == '"' ? "\"\"" : std::string(1, c);
    for (const Sphere& s : spheres)
      text += name + "\"," + coordinates(s.center, ",") + ',' + digits(s.radius) + '\n';
  }
  return text;
}

void export_packing(const std::string& path, const std::vector<Sphere>& spheres,
                    const std::string& link) {
  const RobotSpheres robot{link, {{link, spheres}}};
  const auto content = [&]() -> std::string {
    switch (export_format(path)) {
      case ExportFormat::spheres:
        return view::spheres_as(*view::sphere_format(path), spheres);
      case ExportFormat::json:
        return packing_as_json(spheres);
      case ExportFormat::vtk:
        return packing_as_vtk(spheres);
      case ExportFormat::yml:
        return packing_as_yml(robot);
      case ExportFormat::xrdf:
        return packing_as_xrdf(robot);
      case ExportFormat::urdf:
        return packing_as_urdf(robot);
      case ExportFormat::srdf:
        return packing_as_srdf(robot);
    }
    return "";
  };
  file::write_all(path, content());
}

}  // namespace vpm
