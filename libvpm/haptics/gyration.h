// Radius of gyration of a tool, from which a virtual coupling gets its inertia.
#pragma once

#include "libvpm/model/tool_model.h"

namespace vpm {

// Returns the radius of gyration, m: that of a ball with the tool's mean moment of inertia, for
// uniform density.
double radius_of_gyration(const ToolModel& tool);

}  // namespace vpm
