#include "libvpm/packing/packing_export.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY bodies are copied as they are");

std::string digits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// Returns blue over green to red for t in [0, 1].
std::array<std::uint8_t, 3> rainbow(double t) {
  const auto channel = [&](double peak) {
    return static_cast<std::uint8_t>(
        std::lround(255 * std::clamp(1.5 - std::abs(4 * t - peak), 0.0, 1.0)));
  };
  return {channel(3), channel(2), channel(1)};
}

// Returns x, y and z with `between` between them.
std::string text_of(Vec3 p, const char* between) {
  return digits(p.x) + between + digits(p.y) + between + digits(p.z);
}

// Colours spheres by radius within their packing.
class RadiusColors {
 public:
  explicit RadiusColors(const std::vector<Sphere>& spheres) {
    for (const Sphere& s : spheres) {
      smallest_ = std::min(smallest_, s.radius);
      largest_ = std::max(largest_, s.radius);
    }
  }
  std::array<std::uint8_t, 3> of(const Sphere& s) const {
    return rainbow(
        largest_ > smallest_ ? std::log(s.radius / smallest_) / std::log(largest_ / smallest_) : 1);
  }

 private:
  double smallest_ = HUGE_VAL, largest_ = 0;
};

constexpr const char* kPlyHeader =
    "ply\nformat binary_little_endian 1.0\ncomment spheres of a packing, coloured by radius\n"
    "element vertex ";
constexpr const char* kPlyCorners =
    "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    "property uchar green\nproperty uchar blue\n";

// Returns the name as a JSON string, which is valid YAML too. Invalid UTF-8 becomes U+FFFD.
std::string json_text(const std::string& name) {
  return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Returns the name escaped for XML attributes; invalid UTF-8 becomes U+FFFD.
std::string xml_text(const std::string& name) {
  std::string text;
  for (const char c : nlohmann::json::parse(json_text(name)).get<std::string>()) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:  // XML cannot express control characters
        text += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return text;
}

}  // namespace

ExportFormat export_format(const std::string& path) {
  const auto ends = [&](const char* extension) { return path.ends_with(extension); };
  if (ends(".csv")) return ExportFormat::csv;
  if (ends(".json")) return ExportFormat::json;
  if (ends(".points.ply")) return ExportFormat::points;
  if (ends(".ply")) return ExportFormat::ply;
  if (ends(".vtk")) return ExportFormat::vtk;
  if (ends(".yml") || ends(".yaml")) return ExportFormat::yml;
  if (ends(".urdf")) return ExportFormat::urdf;
  if (ends(".srdf")) return ExportFormat::srdf;
  throw Error(
      ErrorKind::invalid_argument,
      "the name '" + path +
          "' must end with .csv, .json, .ply (.points.ply), .vtk, .yml (.yaml), .urdf or .srdf",
      "export");
}

std::string packing_as_csv(const std::vector<Sphere>& spheres) {
  std::string text = "x,y,z,r\n";
  for (const Sphere& s : spheres) {
    text += text_of(s.center, ",") + ',' + digits(s.radius) + '\n';
  }
  return text;
}

std::string packing_as_json(const std::vector<Sphere>& spheres) {
  nlohmann::json centers = nlohmann::json::array(), radii = nlohmann::json::array();
  for (const Sphere& s : spheres) {
    centers.push_back({s.center.x, s.center.y, s.center.z});
    radii.push_back(s.radius);
  }
  return nlohmann::json{{"centers", centers}, {"radii", radii}}.dump() + "\n";
}

std::string packing_as_ply(const std::vector<Sphere>& spheres) {
  const Solid ball = synthetic::make_icosphere(1, 1);
  const std::size_t corners = ball.vertices.size(), faces = ball.triangles.size();
  if (corners * spheres.size() > 0xffffffff) {
    refuse("too many spheres for the 32-bit indices of a PLY file", "export", "use .points.ply");
  }
  std::string bytes = kPlyHeader + std::to_string(corners * spheres.size()) + kPlyCorners +
                      "element face " + std::to_string(faces * spheres.size()) +
                      "\nproperty list uchar uint vertex_indices\nend_header\n";
  const RadiusColors colors(spheres);
  for (const Sphere& s : spheres) {
    const auto color = colors.of(s);
    for (const Vec3& direction : ball.vertices) {
      append(bytes, narrow(s.center + s.radius * direction));
      append(bytes, color);
    }
  }
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    for (const Triangle& t : ball.triangles) {
      append(bytes, std::uint8_t{3});
      for (const std::uint32_t corner : t)
        append(bytes, static_cast<std::uint32_t>(corners * k + corner));
    }
  }
  return bytes;
}

std::string packing_as_points(const std::vector<Sphere>& spheres) {
  std::string bytes = kPlyHeader + std::to_string(spheres.size()) + kPlyCorners +
                      "property float radius\nend_header\n";
  const RadiusColors colors(spheres);
  for (const Sphere& s : spheres) {
    append(bytes, narrow(s.center));
    append(bytes, colors.of(s));
    append(bytes, static_cast<float>(s.radius));
  }
  return bytes;
}

std::string packing_as_vtk(const std::vector<Sphere>& spheres) {
  const std::string count = std::to_string(spheres.size());
  std::string text =
      "# vtk DataFile Version 3.0\nspheres of a packing\nASCII\nDATASET POLYDATA\nPOINTS " + count +
      " double\n";
  for (const Sphere& s : spheres) text += text_of(s.center, " ") + '\n';
  text += "VERTICES " + count + ' ' + std::to_string(2 * spheres.size()) + '\n';
  for (std::size_t k = 0; k < spheres.size(); ++k) text += "1 " + std::to_string(k) + '\n';
  text += "POINT_DATA " + count + "\nSCALARS radius double 1\nLOOKUP_TABLE default\n";
  for (const Sphere& s : spheres) text += digits(s.radius) + '\n';
  return text;
}

std::string packing_as_yml(const std::vector<Sphere>& spheres, const std::string& link) {
  // JSON strings are YAML strings.
  std::string text = "collision_spheres:\n  " + json_text(link) + ":\n";
  for (const Sphere& s : spheres) {
    text += "    - \"center\": [" + text_of(s.center, ", ") +
            "]\n      \"radius\": " + digits(s.radius) + '\n';
  }
  return text;
}

std::string packing_as_urdf(const std::vector<Sphere>& spheres, const std::string& link) {
  const std::string name = xml_text(link);
  std::string text =
      "<?xml version=\"1.0\"?>\n<robot name=\"" + name + "\">\n  <link name=\"" + name + "\">\n";
  for (const Sphere& s : spheres) {
    text += "    <collision>\n      <origin xyz=\"" + text_of(s.center, " ") +
            "\" rpy=\"0 0 0\"/>\n      <geometry><sphere radius=\"" + digits(s.radius) +
            "\"/></geometry>\n    </collision>\n";
  }
  return text + "  </link>\n</robot>\n";
}

std::string packing_as_srdf(const std::vector<Sphere>& spheres, const std::string& link) {
  const std::string name = xml_text(link);
  std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"" + name +
                     "\">\n  <link_sphere_approximation link=\"" + name + "\">\n";
  for (const Sphere& s : spheres) {
    text += "    <sphere center=\"" + text_of(s.center, " ") + "\" radius=\"" + digits(s.radius) +
            "\"/>\n";
  }
  return text + "  </link_sphere_approximation>\n</robot>\n";
}

void export_packing(const std::string& path, const std::vector<Sphere>& spheres,
                    const std::string& link) {
  const auto content = [&]() -> std::string {
    switch (export_format(path)) {
      case ExportFormat::csv:
        return packing_as_csv(spheres);
      case ExportFormat::json:
        return packing_as_json(spheres);
      case ExportFormat::ply:
        return packing_as_ply(spheres);
      case ExportFormat::points:
        return packing_as_points(spheres);
      case ExportFormat::vtk:
        return packing_as_vtk(spheres);
      case ExportFormat::yml:
        return packing_as_yml(spheres, link);
      case ExportFormat::urdf:
        return packing_as_urdf(spheres, link);
      case ExportFormat::srdf:
        return packing_as_srdf(spheres, link);
    }
    return "";
  };
  file::write_all(path, content());
}

}  // namespace vpm
