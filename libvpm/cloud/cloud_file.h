#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"

namespace vpm {

// Refuse (Error(refused)) whatever is not a sound file of this kind: see formats/. "-" is standard
// input.
Cloud read_cloud(const std::string& path);
Cloud parse_cloud(std::vector<std::byte> bytes, const std::string& name);

// Atomic; "-" is standard output. Throws Error(cannot_write).
void write_cloud(const std::string& path, const Cloud& cloud);

}  // namespace vpm
