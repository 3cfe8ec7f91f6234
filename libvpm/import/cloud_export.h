// Exports clouds for other programs.
#pragma once

#include <string>

#include "libvpm/cloud/cloud.h"

namespace vpm {

// Returns binary little-endian PLY: x y z (double, world), nx ny nz, radius (float), in the cloud's
// order.
std::string to_ply(const Cloud& cloud);

// Returns binary PCD 0.7 with x y z normal_x normal_y normal_z (float32). A cloud with a sensor
// keeps its grid, NaN where unmeasured or without normal, in camera coordinates with the camera's
// pose as VIEWPOINT. Any other is relative to its origin, which is the VIEWPOINT.
std::string to_pcd(const Cloud& cloud);

// Writes by the extension of `path`, .ply or .pcd; any other throws Error(invalid_argument).
void write_points(const std::string& path, const Cloud& cloud);
void check_points_path(const std::string& path);

}  // namespace vpm
