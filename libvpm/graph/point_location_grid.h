#pragma once

#include <span>

#include "libvpm/model/tool_model.h"

namespace vpm {

// The grid of PointLocationGrid over the box of the spheres. A point strictly inside of a sphere
// lies in a cell that lists the sphere, also where floor((x - low) / cell) rounds.
PointLocationGrid build_point_location_grid(std::span<const Sphere> spheres);

}  // namespace vpm
