// Files that must be refused, and what the refusal must say.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/file/container.h"

namespace vpm::golden {

// The bytes with all checksums made right again, as far as the tables still make sense.
std::vector<std::byte> resealed(std::vector<std::byte> bytes);

struct RefusedFile {
  std::string name;
  file::Kind kind;      // as which it is read
  std::string message;  // a part of the refusal
  std::vector<std::byte> bytes;
};

// Made from sound files, one defect each; apart from checksum_*, all checksums are right.
std::vector<RefusedFile> refused_files(const std::vector<std::byte>& packing,
                                       const std::vector<std::byte>& model,
                                       const std::vector<std::byte>& calibrated_model,
                                       const std::vector<std::byte>& cloud);

}  // namespace vpm::golden
