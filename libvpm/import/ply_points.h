#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "libvpm/import/point_set.h"

namespace vpm {

// The vertices of a PLY file (ascii, binary of either byte order): x y z and, if there, nx ny nz.
// Other elements and properties are passed over. Throws Error(refused) naming `name` and the
// defect; counts are compared with the file's size before memory is taken.
PointSet parse_ply_points(std::span<const std::byte> bytes, const std::string& name);

}  // namespace vpm
