// Files that must be refused, with a part of the message.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/file/container.h"

namespace vpm::golden {

// Renews all checksums, as far as the tables still make sense.
std::vector<std::byte> resealed(std::vector<std::byte> bytes);

struct RefusedFile {
  std::string name;
  file::Kind kind;      // kind of file that the reader asks for
  std::string message;  // part of the refusal
  std::vector<std::byte> bytes;
};

// Makes files from sound ones with one defect each; apart from checksum_*, all checksums are right.
std::vector<RefusedFile> refused_files(const std::vector<std::byte>& packing,
                                       const std::vector<std::byte>& model,
                                       const std::vector<std::byte>& calibrated_model,
                                       const std::vector<std::byte>& model_with_surface,
                                       const std::vector<std::byte>& model_with_faces,
                                       const std::vector<std::byte>& cloud);

}  // namespace vpm::golden
