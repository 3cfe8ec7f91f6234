// Solids that options name: a model or a mesh, with its pose after an @.
#pragma once

#include <vpm/solid.h>

#include <string>

#include "tools/common/program.h"

namespace vpm::tools {

// A value of --solid or --remove.
struct SolidArgument {
  std::string name;
  Pose at;  // mesh to world
};

// Takes a value apart at its last @, unless a file has all of it as its name. Throws what
// pose_from_text throws, naming the option.
SolidArgument solid_from_text(const std::string& text, const std::string& option);

// Reads a model or a mesh and prepares it, `with_force` for what forces need, too. Throws
// Error(refused) also for a model that keeps no surface.
SolidBody solid_of_file(const Program& program, const std::string& name, bool with_force = true);

}  // namespace vpm::tools
