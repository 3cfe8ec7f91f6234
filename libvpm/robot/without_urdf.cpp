// Takes the place of what reads URDF where urdfdom was not there.
#include <vpm/robot.h>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

[[noreturn]] void refuse_robot(const std::string& path) {
  throw Error(ErrorKind::unavailable, "a robot is not read by this build, which has no urdfdom",
              path, "build it where that is installed (Debian: liburdfdom-dev)");
}

}  // namespace

Robot read_robot(const std::string& path, const RobotOptions&) {
  refuse_robot(path);
}

std::vector<std::array<std::size_t, 2>> ignored_pairs(const Robot&, const std::string& srdf) {
  refuse_robot(srdf);
}

std::string urdf_with_spheres(const std::string& path, const Robot&,
                              std::span<const std::vector<Sphere>>) {
  refuse_robot(path);
}

}  // namespace vpm
