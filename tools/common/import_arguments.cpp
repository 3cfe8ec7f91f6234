#include "tools/common/import_arguments.h"

#include <cmath>
#include <limits>

#include "libvpm/core/error.h"
#include "tools/common/number_checks.h"

namespace vpm::tools {

void declare(CLI::App& app, ImportArguments& a) {
  app.add_option("--intrinsics", a.intrinsics,
                 "Intrinsics of the camera: fx,fy,cx,cy in pixels. An organised PCD needs none")
      ->delimiter(',')
      ->expected(4)
      ->allow_extra_args(false);
  app.add_option("--depth-scale", a.depth_scale,
                 "Units of the file per metre; 1000 for PNG and 1 for others if not given");
  app.add_option("--method", a.method,
                 "Estimate normals by inverse-depth, or by pca as printed in 2017")
      ->check(CLI::IsMember({"inverse-depth", "pca"}))
      ->capture_default_str();
  app.add_option("--window", a.window,
                 "Side in pixels of the window that a normal is estimated from: odd, 3 to 31")
      ->check(whole_number_in(0, std::numeric_limits<int>::max()))
      ->capture_default_str();
  app.add_option(
         "--edge-gate", a.edge_gate,
         "Largest relative difference of inverse depth within one surface; 0 finds no edges")
      ->capture_default_str();
  app.add_option("--camera-pose", a.camera_pose,
                 "Pose of the camera, or of the cloud's frame, in the world: tx,ty,tz,qx,qy,qz,qw");
}

ImportOptions import_options(const Tool& tool, const ImportArguments& a) {
  if (a.depth_scale && !(*a.depth_scale > 0 && std::isfinite(*a.depth_scale)))
    throw Error(ErrorKind::invalid_argument, "--depth-scale must be finite and greater than 0");
  ImportOptions options;
  options.normals = {normal_method_from_text(a.method), a.window, a.edge_gate};
  check_normal_options(options.normals);
  options.units_per_metre = a.depth_scale;
  if (!a.intrinsics.empty()) {
    options.intrinsics = {a.intrinsics[0], a.intrinsics[1], a.intrinsics[2], a.intrinsics[3]};
    check_intrinsics(*options.intrinsics);
  }
  if (!a.camera_pose.empty()) {
    double deviation = 0;
    options.to_world = pose_from_text(a.camera_pose, &deviation);
    if (deviation > kRotationRounding)
      tool.note("--camera-pose: its quaternion is not of unit length and has been normalised");
  }
  return options;
}

}  // namespace vpm::tools
