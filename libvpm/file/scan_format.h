// Tells the formats of depth images and clouds apart by their content.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace vpm::file {

enum class ScanFormat { png, exr, tiff, netpbm, npy, pcd, ply };

// Returns the format that the first bytes show; a PLY may hold a mesh, too.
std::optional<ScanFormat> scan_format(std::span<const std::byte> bytes);

// Returns words for what such a file is, as in "a PNG picture".
const char* describe(ScanFormat format);

}  // namespace vpm::file
