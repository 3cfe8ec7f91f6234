// Tells which pixels of several cameras are worth comparing with each other.
#pragma once

#include <cstdint>

#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

// True if the pixels around one show its smooth surface.
bool is_clear_pixel(const DepthSurface& image, std::int32_t u, std::int32_t v);

}  // namespace vpm
