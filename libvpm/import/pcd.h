#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "libvpm/import/point_set.h"

namespace vpm {

// Parses Point Cloud Data 0.6 or 0.7: ascii, binary, binary_compressed. Takes fields x y z and, if
// present, normal_x normal_y normal_z (float32, float64 or integers), in any order; ignores others.
// Throws Error(refused), naming `name` and the defect. Checks sizes against the file's before
// allocating.
PointSet parse_pcd(std::span<const std::byte> bytes, const std::string& name);

}  // namespace vpm
