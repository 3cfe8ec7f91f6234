// Tells the formats of depth images and clouds apart by their content.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace vpm {

enum class FileFormat { png, exr, tiff, netpbm, npy, pcd, ply };

// Throws Error(refused), naming `name` and what the file seems to be, if it is none of these.
FileFormat format_of(std::span<const std::byte> bytes, const std::string& name);

}  // namespace vpm
