#include "tools/query/registration.h"

#include <vpm/setup_check.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "libvpm/core/pose.h"
#include "tools/common/error_text.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

// Returns a number as text of as many decimals, of which 0 has no sign.
std::string decimals(double number, int count) {
  const double scale = std::pow(10, count);
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", count, std::round(scale * number) / scale + 0.0);
  return text;
}

// Returns the pose as --camera-pose takes it.
std::string text_of(const Pose& pose) {
  const Vec3& t = pose.translation;
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  std::string text;
  for (const double number : {t.x, t.y, t.z}) text += decimals(number, 6) + ",";
  for (const double number : {q.x, q.y, q.z}) text += decimals(number, 7) + ",";
  return text + decimals(q.w, 7);
}

}  // namespace

std::vector<Pose> registered_poses(const Program& program, const std::vector<std::string>& names,
                                   const std::vector<Pose>& told, const std::vector<Body>& images) {
  const Registration found = naming("--register", [&] { return register_cameras(images); });
  constexpr double kMillimetre = 1e3, kDegree = 180 / 3.14159265358979323846;
  char text[300];
  std::snprintf(text, sizeof text,
                "--register: the images disagree by %.2f mm, and disagreed by %.2f mm; they tell "
                "%zu of %zu motions of cameras against each other%s",
                kMillimetre * found.after, kMillimetre * found.before, found.observable,
                found.motions, found.observable < found.motions ? "; the others stay" : "");
  program.note(text);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Pose& now = found.to_world[k];
    const Vec3 turn = rotation_vector(now.rotation * transpose(told[k].rotation));
    std::snprintf(text, sizeof text, ": its camera is moved by %.2f mm and %.3f degrees, to ",
                  kMillimetre * norm(now.translation - told[k].translation), kDegree * norm(turn));
    program.note(names[k] + text + text_of(now));
  }
  return found.to_world;
}

}  // namespace vpm::tools
