// Options of the tools that read depth images.
#pragma once

#include <optional>
#include <string>

#include "libvpm/import/import_cloud.h"
#include "tools/common/program.h"

namespace vpm::tools {

// Values of the options that say how a depth image becomes a cloud, as the user wrote them.
struct ImportArguments {
  std::string intrinsics, camera_pose, axes = "opencv";
  std::optional<double> depth_scale;  // units per metre
  std::string unit, invalid, range, decode, channel, orient;
  bool along_ray = false, flip = false;
  std::string method = "inverse-depth";
  int window = 7;
  double edge_gate = kEdgeGate;
};

// Adds the options to `app`, which writes their values to `arguments`.
void declare(CLI::App& app, ImportArguments& arguments);
// Adds only those that say which camera took the images, and where it stood.
void declare_camera(CLI::App& app, ImportArguments& arguments);

// Returns the values as libvpm takes them, and reads the files that they name; the name of the
// depth image, if there is one, tells which of a file's cameras is its. Throws
// Error(invalid_argument) where one is out of range, and what the files' readers throw; notes what
// these say, and a quaternion that had to be normalised.
ImportOptions import_options(const Program& program, const ImportArguments& arguments,
                             const std::string& image = {});

}  // namespace vpm::tools
