#include "tools/query/spheres_out.h"

#include <array>
#include <charconv>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"

namespace vpm::tools {
namespace {

constexpr std::array<const char*, 3> kColors{"160 160 160", "255 140 0",
                                             "200 0 0"};  // red green blue by state

bool is_ply(const std::string& path) {
  return path.ends_with(".ply");
}

void append(std::string& text, double value) {
  std::array<char, 32> digits{};
  const auto [end, fault] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end);
}

}  // namespace

void check_spheres_path(const std::string& path) {
  if (!is_ply(path) && !path.ends_with(".csv")) {
    throw Error(ErrorKind::invalid_argument,
                "--spheres-out " + path + ": the name must end in .ply or .csv");
  }
}

void write_spheres(const std::string& path, std::span<const Sphere> spheres,
                   std::span<const SphereState> states, const Pose& pose) {
  const bool ply = is_ply(path);
  std::string text = "x,y,z,r,state\n";
  if (ply) {
    text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(spheres.size()) +
           "\nproperty double x\nproperty double y\nproperty double z\nproperty double "
           "radius\nproperty uchar state\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  }
  const char* separator = ply ? " " : ",";
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const Vec3 at = pose * spheres[i].center;
    for (const double value : {at.x, at.y, at.z, spheres[i].radius}) {
      append(text, value);
      text += separator;
    }
    const std::size_t state = static_cast<std::size_t>(states[i]);
    text += std::to_string(state);
    if (ply) text += std::string(" ") + kColors[state];
    text += '\n';
  }
  file::write_all(path, text);
}

}  // namespace vpm::tools
