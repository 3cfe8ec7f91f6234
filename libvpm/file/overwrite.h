// Checks that an output may be written, before the work begins, so that nobody waits for a refusal.
#pragma once

#include <optional>
#include <string>

#include "libvpm/file/kind.h"

namespace vpm::file {

// Throws Error(invalid_argument) if writing to `path` would destroy a file that is not empty, or if
// the name of a container ends like that of another kind of file. Without `kind` the name itself
// chooses what is written. "-", an empty path, pipes and devices always pass.
// Throws Error(cannot_write) if the folder does not exist.
void check_output(const std::string& path, std::optional<Kind> kind);

// Does the same for JSON and JSON Lines, whose name may not end like that of any other kind but
// .txt.
void check_json(const std::string& path);

// Does the same for lines of results, which are CSV if the name ends in .csv, otherwise JSON.
void check_results(const std::string& path);

// Does the same for a page, whose name may not end like that of any other kind.
void check_page(const std::string& path);

// Checks only that the folder exists (--force). Throws Error(cannot_write).
void check_folder_of(const std::string& path);

// True if the file begins as those of this library do: reads its first bytes alone. Pipes, devices
// and what is not there never do.
bool is_container(const std::string& path);

// True if both paths lead to the same regular file, which need not exist yet. Pipes and devices
// never count as the same.
bool is_same_file(const std::string& a, const std::string& b);

}  // namespace vpm::file
