#pragma once

#include <string>

#include "libvpm/haptics/virtual_coupling.h"
#include "libvpm/model/tool_model.h"

namespace vpm::tools {

// "stiffness=500,damping=5,mass=0.0125,rate=1000" in N/m, N s/m, kg and Hz. Left out: the mass that
// is critically damped, `rate`. Throws Error(usage) naming the option.
CouplingParameters coupling_from_text(const std::string& text, const ToolModel& tool, double rate);

// What the parameters cannot stand of a scene of this stiffness (N/m^3), in words; "" if nothing.
std::string coupling_warning(const CouplingParameters& parameters, const ToolModel& tool,
                             double stiffness);
// What a real device needs to render this.
std::string coupling_note(const CouplingParameters& parameters);

struct CoupledStep {
  std::size_t step = 0;
  double time = 0;
  Pose device, tool;
  Result contact;   // of the tool's pose
  Wrench rendered;  // to the user
  CouplingEnergy energy;
};

// One line of results: formats/schemas/coupling-step.json. `frame`: of a replay; "" leaves it out.
std::string coupled_line(const CoupledStep& step, const std::string& frame);

}  // namespace vpm::tools
