#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/model/packing.h"

namespace vpm {

// Reads a packing from a file, from standard input ("-"), or from bytes. Throws Error(refused) if
// it breaks a rule of formats/packing.md.
Packing read_packing(const std::string& path);
Packing parse_packing(std::vector<std::byte> bytes, const std::string& name);

// Writes a packing atomically, or to standard output ("-"). Throws Error(cannot_write).
void write_packing(const std::string& path, const Packing& packing);

}  // namespace vpm
