// Whole files in and out; "-" is standard input or output.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vpm::file {

// Throws Error(refused) where the file is not there, is a folder, or cannot be read.
std::vector<std::byte> read_all(const std::string& path);

// Atomic for a path: the old file or the whole new one, whatever interrupts the run. A pipe, a
// device (/dev/stdout, /dev/null) and "-" are written straight. Throws Error(cannot_write).
void write_all(const std::string& path, std::span<const std::byte> bytes);
void write_all(const std::string& path, std::string_view text);

// Removes the temporary file of a write that is under way, if any. For signal handlers:
// async-signal-safe.
void remove_unfinished_output();

}  // namespace vpm::file
