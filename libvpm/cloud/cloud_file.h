#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"

namespace vpm {

// Reads a cloud from a file, from standard input ("-"), or from bytes. Throws Error(refused) if it
// breaks a rule of formats/cloud.md.
Cloud read_cloud(const std::string& path);
Cloud parse_cloud(std::vector<std::byte> bytes, const std::string& name);

// Writes a cloud atomically, or to standard output ("-"). Throws Error(cannot_write).
void write_cloud(const std::string& path, const Cloud& cloud);

}  // namespace vpm
