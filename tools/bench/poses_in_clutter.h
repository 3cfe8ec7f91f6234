// Random poses of a tool about what a camera has seen, which near steps, edges and holes take a
// query longer than poses before a wall.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/pose.h"

namespace vpm::bench {

// Returns random poses, each about a point of a cloud with a camera, up to 5 cm away from it along
// each axis, with any rotation. The same for the same cloud and number.
std::vector<Pose> poses_in_clutter(const Cloud& cloud, std::size_t count);

}  // namespace vpm::bench
