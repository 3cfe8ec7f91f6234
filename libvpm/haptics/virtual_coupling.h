// Virtual coupling (vpm/virtual_coupling.h), and the radius of gyration from which it gets a tool's
// inertia.
#pragma once

#include <vpm/virtual_coupling.h>

#include "libvpm/core/pose.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Returns the radius of gyration, m: that of a ball with the tool's mean moment of inertia, for
// uniform density.
double radius_of_gyration(const ToolModel& tool);

}  // namespace vpm
