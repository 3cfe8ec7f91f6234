// May an output be written? Asked before the work begins, so that nobody waits for a refusal.
#pragma once

#include <string>

#include "libvpm/file/container.h"

namespace vpm::file {

// Throws Error(usage) where writing to `path` would destroy something else: a container may replace
// an empty file or a container of its own kind; other outputs (reports, tables, meshes) may replace
// anything but a vpm container. "-", an empty path, pipes and devices always pass. Throws
// Error(cannot_write) where the folder is not there.
void check_container_output(const std::string& path, Kind kind);
void check_text_output(const std::string& path);

// The same without asking what would be replaced (--force).
void check_folder_of(const std::string& path);

// Whether two paths lead to one file, which may not be there yet. No pipe or device is the same as
// another.
bool is_same_file(const std::string& a, const std::string& b);

}  // namespace vpm::file
