#pragma once

#include <string>

#include "libvpm/haptics/virtual_coupling.h"
#include "libvpm/model/tool_model.h"

namespace vpm::tools {

// Parses "stiffness=500,damping=5,mass=0.0125,rate=1000" in N/m, N s/m, kg and Hz. If left out, the
// mass is the critically damped one, and the rate is `rate`. Throws Error(invalid_argument) naming
// the option.
CouplingParameters coupling_from_text(const std::string& text, const ToolModel& tool, double rate);

// Returns a warning if the parameters are unstable in a scene of this stiffness (N/m^3), otherwise
// "".
std::string coupling_warning(const CouplingParameters& parameters, const ToolModel& tool,
                             double stiffness);
// Returns a note on the damping that a real device needs to render this.
std::string coupling_note(const CouplingParameters& parameters);

struct CoupledStep {
  std::size_t step = 0;
  double time = 0;
  Pose device, tool;
  Result contact;   // at the tool's pose
  Wrench rendered;  // to the user
  CouplingEnergy energy;
};

// Returns one line of results (formats/schemas/coupling-step.json). `frame` is the file of a
// replay; "" leaves the field out.
std::string coupled_line(const CoupledStep& step, const std::string& frame);

}  // namespace vpm::tools
