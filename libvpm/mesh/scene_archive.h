// Unpacks entries of zip archives, which 3MF files are.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vpm {

struct ZipEntry {
  std::string path;  // in lower case: 3MF compares names so
  std::size_t record;
};

// Returns what the archive's directory lists.
std::vector<ZipEntry> zip_entries(std::string_view zip);

// Returns the entry's bytes, of a damaged one as many as can be unpacked. Throws std::bad_alloc
// where they are more than a file of this size may take.
std::string unpacked(std::string_view zip, const ZipEntry& entry);

}  // namespace vpm
