// Checks that an output may be written, before the work begins, so that nobody waits for a refusal.
#pragma once

#include <string>

#include "libvpm/file/container.h"

namespace vpm::file {

// Throws Error(invalid_argument) if writing to `path` would destroy something else. A container may
// replace an empty file or a container of its own kind; text outputs (reports, tables, meshes) may
// replace anything but a vpm container. "-", an empty path, pipes and devices always pass. Throws
// Error(cannot_write) if the folder does not exist.
void check_container_output(const std::string& path, Kind kind);
void check_text_output(const std::string& path);

// Checks only that the folder exists (--force). Throws Error(cannot_write).
void check_folder_of(const std::string& path);

// True if both paths lead to the same regular file, which need not exist yet. Pipes and devices
// never count as the same.
bool is_same_file(const std::string& a, const std::string& b);

}  // namespace vpm::file
