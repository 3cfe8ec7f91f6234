// The option --coupling: parameters of the spring and damper by which a haptic device holds the
// tool.
#pragma once

#include <string>

#include "libvpm/haptics/virtual_coupling.h"
#include "libvpm/model/tool_model.h"
#include "tools/common/tool.h"

namespace vpm::tools {

// Parses "stiffness=500,damping=5,mass=0.0125,rate=1000" in N/m, N s/m, kg and Hz. If left out, the
// mass is the critically damped one, and the rate is `rate`. Throws Error(invalid_argument) naming
// the option.
CouplingParameters coupling_from_text(const std::string& text, const ToolModel& model, double rate);

// Notes mass, gyration and the damping that a real device needs to render the coupling, and warns
// if it is unstable in a scene of this stiffness (N/m^3).
void note_coupling(const Tool& tool, const CouplingParameters& parameters, const ToolModel& model,
                   double stiffness);

}  // namespace vpm::tools
