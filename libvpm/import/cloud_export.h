// Exports clouds for other programs.
#pragma once

#include <string>

#include "libvpm/cloud/cloud.h"
#include "libvpm/import/remark.h"

namespace vpm {

// Returns binary little-endian PLY, all float32: x y z (world, m), nx ny nz, radius (m), in the
// cloud's order. Points that float32 would round by more than a small part of their spacing are
// written about the cloud's origin, which a line "comment vpm origin X Y Z" tells.
std::string to_ply(const Cloud& cloud);

// Returns binary PCD 0.7 with x y z normal_x normal_y normal_z (float32). A cloud with a sensor
// keeps its grid, NaN where unmeasured or without normal, in camera coordinates with the camera's
// pose as VIEWPOINT. Other points are in the world, or about the cloud's origin as in PLY, which a
// line "# vpm origin X Y Z" tells.
std::string to_pcd(const Cloud& cloud);

// Writes by the extension of `path`, .ply or .pcd; any other throws Error(invalid_argument).
// Returns a note if the points are not written in the world.
Remarks write_points(const std::string& path, const Cloud& cloud);
// Throws Error(invalid_argument) for a path with another extension, before any work is done.
void check_points_path(const std::string& path);

}  // namespace vpm
