#include "libvpm/view/sphere_files.h"

#include <vpm/version.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/synthetic/shapes.h"
#include "libvpm/view/packed.h"

namespace vpm::view {
namespace {

static_assert(std::endian::native == std::endian::little,
              "bodies are copied as they lie in memory");

using Color = std::array<std::uint8_t, 3>;

// Places of the viridis colour map, dark violet to yellow: its lightness rises evenly, also for the
// colour-blind.
constexpr std::array<Color, 5> kViridis{
    {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};

Color viridis(double t) {
  const double at = std::clamp(t, 0.0, 1.0) * (kViridis.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(at), kViridis.size() - 2);
  Color color{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double from = kViridis[k][i], to = kViridis[k + 1][i];
    color[i] =
        static_cast<std::uint8_t>(std::lround(from + (at - static_cast<double>(k)) * (to - from)));
  }
  return color;
}

std::vector<Color> colors_of(std::span<const Sphere> spheres,
                             std::span<const std::uint8_t> states) {
  std::vector<Color> colors;
  for (const std::uint8_t state : states) colors.push_back(kStateLooks[state].rgb);
  if (!states.empty()) return colors;
  double smallest = HUGE_VAL, largest = 0;
  for (const Sphere& s : spheres) {
    smallest = std::min(smallest, s.radius);
    largest = std::max(largest, s.radius);
  }
  for (const Sphere& s : spheres)
    colors.push_back(viridis(
        largest > smallest ? std::log(s.radius / smallest) / std::log(largest / smallest) : 1));
  return colors;
}

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string digits(double value, bool all) {
  std::array<char, 32> text{};
  if (!all) {
    std::snprintf(text.data(), text.size(), "%.9g", value);
    return text.data();
  }
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string as_csv(std::span<const Sphere> spheres, std::span<const std::uint8_t> states) {
  const bool all = !states.empty();
  std::string text = all ? "x,y,z,r,state\n" : "x,y,z,r\n";
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    const Sphere& s = spheres[k];
    text += digits(s.center.x, all) + ',' + digits(s.center.y, all) + ',' +
            digits(s.center.z, all) + ',' + digits(s.radius, all);
    if (all) text += std::string(",") + kStateLooks[states[k]].name;
    text += '\n';
  }
  return text;
}

std::string ply_header(std::size_t vertices, bool has_states) {
  return std::string("ply\nformat binary_little_endian 1.0\ncomment spheres, coloured by ") +
         (has_states ? "state: 0 outside, 1 boundary, 2 inside" : "radius") + "\nelement vertex " +
         std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
         "property uchar green\nproperty uchar blue\n";
}

void refuse_too_many(std::size_t corners, std::size_t spheres) {
  if (corners * spheres > std::numeric_limits<std::uint32_t>::max())
    refuse("export: too many spheres for the 32-bit indices of balls; use .points.ply");
}

std::string as_ply(std::span<const Sphere> spheres, std::span<const std::uint8_t> states) {
  const Solid ball = synthetic::make_icosphere(1, 1);
  const std::size_t corners = ball.vertices.size(), faces = ball.triangles.size();
  refuse_too_many(corners, spheres.size());
  std::string bytes = ply_header(corners * spheres.size(), !states.empty()) + "element face " +
                      std::to_string(faces * spheres.size()) +
                      "\nproperty list uchar uint vertex_indices\nend_header\n";
  const std::vector<Color> colors = colors_of(spheres, states);
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    for (const Vec3& direction : ball.vertices) {
      append(bytes, narrow(spheres[k].center + spheres[k].radius * direction));
      append(bytes, colors[k]);
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

std::string as_points(std::span<const Sphere> spheres, std::span<const std::uint8_t> states) {
  std::string bytes = ply_header(spheres.size(), !states.empty()) + "property float radius\n" +
                      (states.empty() ? "" : "property uchar state\n") + "end_header\n";
  const std::vector<Color> colors = colors_of(spheres, states);
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    append(bytes, narrow(spheres[k].center));
    append(bytes, colors[k]);
    append(bytes, static_cast<float>(spheres[k].radius));
    if (!states.empty()) append(bytes, states[k]);
  }
  return bytes;
}

// A binary glTF: JSON and one buffer. Each group of balls becomes a mesh with a node of its own.
class Glb {
 public:
  explicit Glb(Vec3 origin) : origin_(origin) {}

  void add_balls(const std::string& name, std::span<const Sphere> spheres,
                 const std::vector<Color>& colors, const std::vector<std::size_t>& members) {
    const Solid ball = synthetic::make_icosphere(1, 1);
    refuse_too_many(ball.vertices.size(), members.size());
    Box box;
    std::string positions, normals, tints, indices;
    for (std::size_t m = 0; m < members.size(); ++m) {
      const Sphere& s = spheres[members[m]];
      for (const Vec3& direction : ball.vertices) {
        const Vec3f at = narrow(s.center - origin_ + s.radius * direction);
        box.add(widen(at));
        append(positions, at);
        append(normals, narrow(direction));
        append(tints, colors[members[m]]);
        append(tints, std::uint8_t{255});
      }
      for (const Triangle& t : ball.triangles)
        for (const std::uint32_t corner : t)
          append(indices, static_cast<std::uint32_t>(ball.vertices.size() * m + corner));
    }
    const std::size_t corners = ball.vertices.size() * members.size();
    Json position = accessor(positions, kFloat, "VEC3", corners, kVertices);
    position["min"] = {box.low.x, box.low.y, box.low.z};
    position["max"] = {box.high.x, box.high.y, box.high.z};
    Json color = accessor(tints, kByte, "VEC4", corners, kVertices);
    color["normalized"] = true;
    const std::size_t first = accessors_.size();
    accessors_.push_back(std::move(position));
    accessors_.push_back(accessor(normals, kFloat, "VEC3", corners, kVertices));
    accessors_.push_back(std::move(color));
    accessors_.push_back(accessor(indices, kIndex, "SCALAR",
                                  3 * ball.triangles.size() * members.size(), kTriangles));
    const Json primitive{
        {"attributes", {{"POSITION", first}, {"NORMAL", first + 1}, {"COLOR_0", first + 2}}},
        {"indices", first + 3},
        {"material", 0}};
    nodes_.push_back({{"name", name},
                      {"mesh", meshes_.size()},
                      {"translation", {origin_.x, origin_.y, origin_.z}}});
    meshes_.push_back({{"name", name}, {"primitives", Json::array({primitive})}});
  }

  std::string bytes() const {
    Json roots = Json::array();
    for (std::size_t k = 0; k < nodes_.size(); ++k) roots.push_back(k);
    const Json document{
        {"asset", {{"version", "2.0"}, {"generator", "vpm " VPM_VERSION}}},
        {"scene", 0},
        {"scenes", Json::array({{{"nodes", roots}}})},
        {"nodes", nodes_},
        {"meshes", meshes_},
        {"materials", Json::array({{{"pbrMetallicRoughness",
                                     {{"metallicFactor", 0}, {"roughnessFactor", 0.8}}}}})},
        {"accessors", accessors_},
        {"bufferViews", views_},
        {"buffers", Json::array({{{"byteLength", buffer_.size()}}})}};
    std::string json = document.dump();
    json.append((4 - json.size() % 4) % 4, ' ');
    std::string bytes = "glTF";
    append(bytes, std::uint32_t{2});
    append(bytes, static_cast<std::uint32_t>(28 + json.size() + buffer_.size()));
    append(bytes, static_cast<std::uint32_t>(json.size()));
    bytes += "JSON" + json;
    append(bytes, static_cast<std::uint32_t>(buffer_.size()));
    bytes.append("BIN\0", 4);
    return bytes + buffer_;
  }

 private:
  static constexpr int kByte = 5121, kIndex = 5125, kFloat = 5126, kVertices = 34962,
                       kTriangles = 34963;

  // All parts are multiples of four bytes, as the format demands.
  Json accessor(const std::string& part, int component, const char* type, std::size_t count,
                int target) {
    views_.push_back({{"buffer", 0},
                      {"byteOffset", buffer_.size()},
                      {"byteLength", part.size()},
                      {"target", target}});
    buffer_ += part;
    return {{"bufferView", views_.size() - 1},
            {"componentType", component},
            {"count", count},
            {"type", type}};
  }

  Vec3 origin_;
  std::string buffer_;
  Json nodes_ = Json::array(), meshes_ = Json::array(), accessors_ = Json::array(),
       views_ = Json::array();
};

std::string as_glb(std::span<const Sphere> spheres, std::span<const std::uint8_t> states) {
  Glb file(spheres.empty() ? Vec3{} : spheres.front().center);
  const std::vector<Color> colors = colors_of(spheres, states);
  const std::size_t groups = states.empty() ? 1 : kStateLooks.size();
  for (std::size_t group = 0; group < groups; ++group) {
    std::vector<std::size_t> members;
    for (std::size_t k = 0; k < spheres.size(); ++k)
      if (states.empty() || states[k] == group) members.push_back(k);
    if (!members.empty())
      file.add_balls(states.empty() ? "spheres" : kStateLooks[group].name, spheres, colors,
                     members);
  }
  return file.bytes();
}

}  // namespace

std::optional<SphereFormat> sphere_format(const std::string& path) {
  const std::string name = file::in_lower_case(path);
  if (name.ends_with(".csv")) return SphereFormat::csv;
  if (name.ends_with(".points.ply")) return SphereFormat::points;
  if (name.ends_with(".ply")) return SphereFormat::ply;
  if (name.ends_with(".glb")) return SphereFormat::glb;
  return std::nullopt;
}

std::string spheres_as(SphereFormat format, std::span<const Sphere> spheres,
                       std::span<const std::uint8_t> states) {
  switch (format) {
    case SphereFormat::csv:
      return as_csv(spheres, states);
    case SphereFormat::ply:
      return as_ply(spheres, states);
    case SphereFormat::points:
      return as_points(spheres, states);
    case SphereFormat::glb:
      return as_glb(spheres, states);
  }
  return "";
}

}  // namespace vpm::view
