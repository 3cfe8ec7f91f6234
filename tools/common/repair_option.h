// The words of vpm-pack --repair, which vpm-graph finds in a packing's provenance.
#pragma once

#include <string_view>

#include "libvpm/mesh/mesh_check.h"

namespace vpm::tools {

// "holes", "voxel", "voxel=RES", "flood" or "flood=RES"; false for another word.
bool parse_repair(std::string_view word, SolidOptions& options);

}  // namespace vpm::tools
