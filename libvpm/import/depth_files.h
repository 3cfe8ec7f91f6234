// Depth images of other programs. Values that mean "nothing measured" (0, negative, NaN, infinite)
// come out as 0.
//
// All throw Error(refused) naming `name` and the defect, for whatever is damaged or no depth image.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "libvpm/cloud/depth_image.h"

namespace vpm {

// 16-bit gray PNG; depth = value / units_per_metre.
DepthImage parse_png_depth(std::span<const std::byte> bytes, const std::string& name,
                           double units_per_metre);

// OpenEXR with channel Z, or Y, or R = G = B; HALF or FLOAT; depth = value / units_per_metre.
// Throws Error(unavailable) in a build without OpenEXR.
DepthImage parse_exr_depth(std::span<const std::byte> bytes, const std::string& name,
                           double units_per_metre);

// Refuses sizes of 0 and of more pixels than kMaxPoints.
void check_image_size(std::uint64_t width, std::uint64_t height, const std::string& name);

}  // namespace vpm
