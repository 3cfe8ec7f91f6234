// How a tool's mass is spread, for the inertia that a virtual coupling gives it.
#pragma once

#include "libvpm/model/tool_model.h"

namespace vpm {

// Metres; that of a ball with the tool's mean moment of inertia, for a solid of one density.
double radius_of_gyration(const ToolModel& tool);

}  // namespace vpm
