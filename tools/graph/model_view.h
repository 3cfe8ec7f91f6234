// vpm-graph --view: the sphere graph of each level, its bridges, and the spheres' cells.
#pragma once

#include <string>

#include "libvpm/model/solid.h"
#include "libvpm/model/tool_model.h"

namespace vpm::tools {

void write_model_view(const std::string& path, const std::string& packing, const ToolModel& model,
                      const Solid& mesh);

}  // namespace vpm::tools
