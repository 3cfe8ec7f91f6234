// Opens a list of bodies that are the depth images of several cameras.
#pragma once

#include <vpm/scene.h>

#include <span>
#include <vector>

#include "libvpm/scene/depth/depth_body.h"

namespace vpm {

// Throws Error(invalid_argument) for a body that is no depth image.
std::vector<DepthBody> depth_images_of(std::span<const Body> bodies);

}  // namespace vpm
