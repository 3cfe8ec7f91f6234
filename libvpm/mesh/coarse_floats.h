// Finds meshes so far from the origin that coordinates of 32 bits have lost their shape.
#pragma once

#include <string>

#include "libvpm/mesh/mesh_reader.h"

namespace vpm {

// Returns what is wrong, with lengths in the file's unit, if all coordinates are floats of 32 bits
// and neighbours of the farthest one are more than 1/10 000 of the mesh's diagonal apart; otherwise
// an empty text.
std::string coarse_floats(const RawMesh& mesh);

}  // namespace vpm
