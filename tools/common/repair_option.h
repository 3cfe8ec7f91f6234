// Values of vpm-pack --repair. A packing's provenance keeps them, and vpm-graph reads them there.
#pragma once

#include <string_view>

#include "libvpm/mesh/mesh_check.h"

namespace vpm::tools {

// Sets the repair that `word` names: holes, voxel, voxel=RES, flood or flood=RES. Returns false for
// any other word.
bool parse_repair(std::string_view word, SolidOptions& options);

}  // namespace vpm::tools
