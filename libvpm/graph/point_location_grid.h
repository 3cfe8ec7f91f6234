#pragma once

#include <span>

#include "libvpm/model/tool_model.h"

namespace vpm {

// Builds the grid over the bounding box of the spheres. A point strictly inside a sphere lies in a
// grid cell that lists the sphere, even where floor((x - low) / cell) rounds.
PointLocationGrid build_point_location_grid(std::span<const Sphere> spheres);

}  // namespace vpm
