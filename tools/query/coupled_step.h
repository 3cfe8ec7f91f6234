// Result lines of a haptic device that holds the tool.
#pragma once

#include <cstddef>
#include <string>

#include "libvpm/haptics/virtual_coupling.h"

namespace vpm::tools {

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
std::string coupled_line(const CoupledStep& step, const std::string& frame);

}  // namespace vpm::tools
