#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "libvpm/import/point_set.h"

namespace vpm {

// Parses the vertices of a PLY file (ascii, or binary of either byte order): x y z and, if present,
// nx ny nz; ignores other elements and properties. Throws Error(refused), naming `name` and the
// defect. Checks counts against the file's size before allocating.
PointSet parse_ply_points(std::span<const std::byte> bytes, const std::string& name);

}  // namespace vpm
