#include "tools/query/registration.h"

#include <vpm/setup_check.h>

#include <cstdio>

#include "libvpm/core/pose.h"
#include "tools/common/error_text.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {

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
    const Quaternion q = quaternion_from_rotation(now.rotation);
    const Vec3 turn = rotation_vector(now.rotation * transpose(told[k].rotation));
    std::snprintf(text, sizeof text,
                  ": its camera is moved by %.2f mm and %.3f degrees, to "
                  "%.6f,%.6f,%.6f,%.7f,%.7f,%.7f,%.7f",
                  kMillimetre * norm(now.translation - told[k].translation), kDegree * norm(turn),
                  now.translation.x, now.translation.y, now.translation.z, q.x, q.y, q.z, q.w);
    program.note(names[k] + text);
  }
  return found.to_world;
}

}  // namespace vpm::tools
