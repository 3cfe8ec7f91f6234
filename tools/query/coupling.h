// The spring and damper by which a haptic device holds the tool: the option --coupling, and lines
// of results.
#pragma once

#include <vpm/tool.h>
#include <vpm/virtual_coupling.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/common/program.h"

namespace vpm::tools {

// Parses "stiffness=500,damping=5,mass=0.0125,rate=1000" in N/m, N s/m, kg and Hz. If left out, the
// mass is the critically damped one, and the rate is `rate`. Throws Error(invalid_argument) naming
// the option.
CouplingParameters coupling_from_text(const std::string& text, const Tool& tool, double rate);

// Notes mass, gyration and the damping that a real device needs to render the coupling, and warns
// if it is unstable in a scene of this stiffness (N/m^3).
void note_coupling(const Program& program, const CouplingParameters& parameters, const Tool& tool,
                   double stiffness);

// Step of a haptic device that holds the tool by a spring and a damper.
struct CoupledStep {
  std::size_t step = 0;
  double time = 0;    // s since the first step
  Pose device, tool;  // in the world
  Result contact;     // answer for the tool at its pose
  Wrench rendered;    // on the user, in N and N m
  CouplingEnergy energy;
};

// Returns one line of results (formats/schemas/coupling-step.json). `frame` is the name of a
// recorded frame; "" leaves the field out.
nlohmann::ordered_json coupled_line(const CoupledStep& step, const std::string& frame);

}  // namespace vpm::tools
