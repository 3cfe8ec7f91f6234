// Options of the tools that read depth images.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libvpm/import/import_cloud.h"
#include "tools/common/tool.h"

namespace vpm::tools {

// Values of the options that say how a depth image becomes a cloud; pixels, units per metre.
struct ImportArguments {
  std::vector<double> intrinsics;
  std::optional<double> depth_scale;
  std::string method = "inverse-depth", camera_pose;
  int window = 7;
  double edge_gate = kEdgeGate;
};

// Adds the options to `app`, which writes their values to `arguments`.
void declare(CLI::App& app, ImportArguments& arguments);

// Returns the values as libvpm takes them. Throws Error(invalid_argument) where one is out of
// range; notes a quaternion that had to be normalised.
ImportOptions import_options(const Tool& tool, const ImportArguments& arguments);

}  // namespace vpm::tools
