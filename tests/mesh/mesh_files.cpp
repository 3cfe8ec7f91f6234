#include "tests/mesh/mesh_files.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "libvpm/core/error.h"
#include "tests/refusal.h"

namespace vpm::test {
namespace {

std::string text(double value) {
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.17g", value);
  return digits;
}

std::string text(Vec3 p) {
  return text(p.x) + " " + text(p.y) + " " + text(p.z);
}

template <class T>
void append(std::string& bytes, T value, bool swap = false) {
  std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
  if (swap) std::reverse(raw.begin(), raw.end());
  bytes += raw;
}

std::string ply_header(const Solid& solid, const std::string& format) {
  return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex " +
         std::to_string(solid.vertices.size()) +
         "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
         std::to_string(solid.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string indices(const Triangle& t, std::uint32_t first) {
  return std::to_string(t[0] + first) + " " + std::to_string(t[1] + first) + " " +
         std::to_string(t[2] + first);
}

}  // namespace

std::string as_obj(const Solid& solid) {
  std::string out = "# a test\n";
  for (const Vec3& p : solid.vertices) out += "v " + text(p) + "\n";
  for (const Triangle& t : solid.triangles) out += "f " + indices(t, 1) + "\n";
  return out;
}

std::string as_off(const Solid& solid) {
  std::string out = "OFF\n" + std::to_string(solid.vertices.size()) + " " +
                    std::to_string(solid.triangles.size()) + " 0\n";
  for (const Vec3& p : solid.vertices) out += text(p) + "\n";
  for (const Triangle& t : solid.triangles) out += "3 " + indices(t, 0) + "\n";
  return out;
}

std::string as_ascii_ply(const Solid& solid) {
  std::string out = ply_header(solid, "ascii");
  for (const Vec3& p : solid.vertices) out += text(p) + "\n";
  for (const Triangle& t : solid.triangles) out += "3 " + indices(t, 0) + "\n";
  return out;
}

std::string as_binary_ply(const Solid& solid, bool big_endian) {
  std::string out = ply_header(solid, big_endian ? "binary_big_endian" : "binary_little_endian");
  for (const Vec3& p : solid.vertices) {
    for (const double c : {p.x, p.y, p.z}) append(out, c, big_endian);
  }
  for (const Triangle& t : solid.triangles) {
    append(out, std::uint8_t{3});
    for (const std::uint32_t corner : t) append(out, corner, big_endian);
  }
  return out;
}

std::string as_ascii_stl(const Solid& solid) {
  std::string out = "solid test\n";
  for (const Triangle& t : solid.triangles) {
    out += "facet normal 0 0 0\n outer loop\n";
    for (const std::uint32_t corner : t) out += "  vertex " + text(solid.vertices[corner]) + "\n";
    out += " endloop\nendfacet\n";
  }
  return out + "endsolid\n";
}

std::string as_binary_stl(const Solid& solid) {
  std::string out(80, ' ');
  append(out, static_cast<std::uint32_t>(solid.triangles.size()));
  for (const Triangle& t : solid.triangles) {
    append(out, Vec3f{});
    for (const std::uint32_t corner : t) append(out, narrow(solid.vertices[corner]));
    append(out, std::uint16_t{0});
  }
  return out;
}

RawMesh parse(const std::string& content, const std::string& name) {
  return parse_mesh(std::as_bytes(std::span(content.data(), content.size())), name);
}

CheckedSolid solid_of(const std::string& content, const std::string& name,
                      const SolidOptions& options) {
  return make_solid(parse(content, name), options);
}

CheckedSolid solid_of(const Solid& solid, const SolidOptions& options) {
  return solid_of(as_off(solid), "test.off", options);
}

std::string refusal_of(const std::string& content, const std::string& name,
                       const SolidOptions& options) {
  const auto fault = fault_of([&] { solid_of(content, name, options); });
  return fault && fault->kind() == ErrorKind::refused ? fault->what() : "";
}

std::string refusal_of(const Solid& solid) {
  return refusal_of(as_off(solid), "test.off");
}

Solid together(const Solid& a, const Solid& b) {
  Solid both = a;
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  both.vertices.insert(both.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles)
    both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return both;
}

Solid moved(Solid solid, Vec3 by) {
  for (Vec3& p : solid.vertices) p += by;
  return solid;
}

Solid turned_over(Solid solid) {
  for (Triangle& t : solid.triangles) std::swap(t[1], t[2]);
  return solid;
}

std::string shared_mesh(const std::string& name) {
  const std::string path = std::string(VPM_SOURCE_DIR) + "/../shared/data/meshes/" + name;
  return std::filesystem::exists(path) ? path : "";
}

}  // namespace vpm::test
