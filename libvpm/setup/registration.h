// Moves several cameras by so little that their images agree, as far as the images tell.
#pragma once

#include <vpm/setup_check.h>

#include <span>

#include "libvpm/scene/depth/depth_body.h"

namespace vpm {

// Returns what register_cameras() of vpm/setup_check.h does. The order of images changes no bit.
Registration register_images(std::span<const DepthBody> images);

}  // namespace vpm
