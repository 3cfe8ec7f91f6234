// Finds a camera that is probably at another place than its pose tells, or whose depths are in
// another unit: other cameras saw free what it shows, or it sees free what they show. Finds what is
// too thin for how well cameras on its two sides agree.
#pragma once

#include <vpm/setup_check.h>

#include <optional>
#include <span>

#include "libvpm/scene/depth/depth_body.h"

namespace vpm {

// Compares each image with each other one. Returns the camera that contradicts others most, else
// one that is far from them, else one that shows nothing that they show; nothing where they can be
// as they are told, or there is one only.
std::optional<DoubtedCamera> check_cameras(std::span<const DepthBody> images);

// Returns what uncertain_thickness() of vpm/setup_check.h does. The order of images changes
// nothing.
std::optional<Remark> check_thickness(std::span<const DepthBody> images);

}  // namespace vpm
