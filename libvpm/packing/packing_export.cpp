#include "libvpm/packing/packing_export.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>

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

// Blue over green to red for 0 .. 1.
std::array<std::uint8_t, 3> rainbow(double t) {
  const auto channel = [&](double peak) {
    return static_cast<std::uint8_t>(
        std::lround(255 * std::clamp(1.5 - std::abs(4 * t - peak), 0.0, 1.0)));
  };
  return {channel(3), channel(2), channel(1)};
}

}  // namespace

ExportFormat export_format(const std::string& path) {
  const auto ends = [&](const char* extension) { return path.ends_with(extension); };
  if (ends(".csv")) return ExportFormat::csv;
  if (ends(".ply")) return ExportFormat::ply;
  if (ends(".yml") || ends(".yaml")) return ExportFormat::yml;
  throw Error(ErrorKind::usage,
              "export: the name '" + path + "' must end with .csv, .ply or .yml (.yaml)");
}

std::string packing_as_csv(const std::vector<Sphere>& spheres) {
  std::string text = "x,y,z,r\n";
  for (const Sphere& s : spheres) {
    text += digits(s.center.x) + ',' + digits(s.center.y) + ',' + digits(s.center.z) + ',' +
            digits(s.radius) + '\n';
  }
  return text;
}

std::string packing_as_ply(const std::vector<Sphere>& spheres) {
  const Solid ball = synthetic::make_icosphere(1, 1);
  const std::size_t corners = ball.vertices.size(), faces = ball.triangles.size();
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment spheres of a packing, coloured by radius\n"
      "element vertex " +
      std::to_string(corners * spheres.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nelement face " +
      std::to_string(faces * spheres.size()) +
      "\nproperty list uchar uint vertex_indices\nend_header\n";
  if (corners * spheres.size() > 0xffffffff)
    refuse("export: too many spheres for the 32-bit indices of a PLY file; use .csv");
  double smallest = HUGE_VAL, largest = 0;
  for (const Sphere& s : spheres) {
    smallest = std::min(smallest, s.radius);
    largest = std::max(largest, s.radius);
  }
  for (const Sphere& s : spheres) {
    const double t =
        largest > smallest ? std::log(s.radius / smallest) / std::log(largest / smallest) : 1;
    const auto color = rainbow(t);
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

std::string packing_as_yml(const std::vector<Sphere>& spheres, const std::string& link) {
  std::string text = "collision_spheres:\n  \"" + link + "\":\n";
  for (const Sphere& s : spheres) {
    text += "    - \"center\": [" + digits(s.center.x) + ", " + digits(s.center.y) + ", " +
            digits(s.center.z) + "]\n      \"radius\": " + digits(s.radius) + '\n';
  }
  return text;
}

void export_packing(const std::string& path, const std::vector<Sphere>& spheres,
                    const std::string& link) {
  switch (export_format(path)) {
    case ExportFormat::csv:
      return file::write_all(path, packing_as_csv(spheres));
    case ExportFormat::ply:
      return file::write_all(path, packing_as_ply(spheres));
    case ExportFormat::yml:
      return file::write_all(path, packing_as_yml(spheres, link));
  }
}

}  // namespace vpm
