// Reads depth images of other programs. Values for "nothing measured" (0, negative, NaN, infinite)
// become 0.
//
// All functions throw Error(refused), naming `name` and the defect, for damaged files and those
// that are no depth image.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "libvpm/cloud/depth_image.h"

namespace vpm {

// Reads a 16-bit gray PNG; depth = value / units_per_metre.
DepthImage parse_png_depth(std::span<const std::byte> bytes, const std::string& name,
                           double units_per_metre);

// Reads OpenEXR with channel Z, or Y, or R = G = B; HALF or FLOAT; depth = value / units_per_metre.
// Throws Error(unavailable) in builds without OpenEXR.
DepthImage parse_exr_depth(std::span<const std::byte> bytes, const std::string& name,
                           double units_per_metre);

// Throws Error(refused) for sizes of 0 and more than kMaxPoints pixels.
void check_image_size(std::uint64_t width, std::uint64_t height, const std::string& name);

}  // namespace vpm
