// How depth images become clouds, as the tools' options say it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libvpm/import/import_cloud.h"
#include "tools/common/tool.h"

namespace vpm::tools {

struct ImportArguments {
  std::vector<double> intrinsics;
  std::optional<double> depth_scale;
  std::string method = "inverse-depth", camera_pose;
  int window = 7;
  double edge_gate = kEdgeGate;
};

void declare(CLI::App& app, ImportArguments& arguments);

// Throws Error(usage) for what is out of range; notes what has been normalised.
ImportOptions import_options(const Tool& tool, const ImportArguments& arguments);

}  // namespace vpm::tools
