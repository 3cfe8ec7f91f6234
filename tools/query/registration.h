// --register: moves cameras by so little that their images agree.
#pragma once

#include <vpm/scene.h>

#include <string>
#include <vector>

#include "tools/common/program.h"

namespace vpm::tools {

// Returns where the cameras of depth images are by what these show, in their order. Prints how each
// is moved, by its name, and by what the images disagree. Throws what register_cameras() throws.
std::vector<Pose> registered_poses(const Program& program, const std::vector<std::string>& names,
                                   const std::vector<Pose>& told, const std::vector<Body>& images);

}  // namespace vpm::tools
