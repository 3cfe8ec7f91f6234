#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "libvpm/import/point_set.h"

namespace vpm {

// Point Cloud Data, version 0.6 or 0.7: ascii, binary and binary_compressed; fields in any order,
// x y z and, if there, normal_x normal_y normal_z (float32, float64 or integers); others are passed
// over. VIEWPOINT becomes the viewpoint. Throws Error(refused) naming `name` and the defect; sizes
// are compared with the file's before memory is taken.
PointSet parse_pcd(std::span<const std::byte> bytes, const std::string& name);

}  // namespace vpm
