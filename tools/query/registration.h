// --register: moves cameras by so little that their images agree.
#pragma once

#include <vpm/scene.h>
#include <vpm/setup_check.h>

#include <string>
#include <vector>

#include "libvpm/import/import_cloud.h"
#include "libvpm/recording/recording.h"
#include "tools/common/program.h"

namespace vpm::tools {

// Returns where the cameras of depth images are by what these show, in their order. Prints how each
// is moved, by its name, and by what the images disagree. Moves none where one is far from where
// its pose tells. Throws what register_cameras() throws.
Registration registered(const Program& program, const std::vector<std::string>& names,
                        const std::vector<Pose>& told, const std::vector<Body>& images);

// Moves the cameras of recordings, each by what the first images of all tell together; where one
// moves along a path, all poses of that by the same motion in its frame. `names` are those of the
// recordings. Prints what registered() prints. Throws Error(refused) if a recording has no image,
// or holds ready clouds, which keep their poses; and whatever registered() throws.
void move_to_agree(const Program& program, const std::vector<std::string>& names,
                   const ImportOptions& import, Recording& recording);

}  // namespace vpm::tools
