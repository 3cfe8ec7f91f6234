#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/model/packing.h"

namespace vpm {

// Refuse (Error(refused)) whatever is not a sound file of this kind: see formats/. "-" is standard
// input.
Packing read_packing(const std::string& path);
Packing parse_packing(std::vector<std::byte> bytes, const std::string& name);

// Atomic; "-" is standard output. Throws Error(cannot_write).
void write_packing(const std::string& path, const Packing& packing);

}  // namespace vpm
