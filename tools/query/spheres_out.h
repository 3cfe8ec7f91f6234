#pragma once

#include <span>
#include <string>

#include "libvpm/core/pose.h"
#include "libvpm/query/tool_query.h"

namespace vpm::tools {

// Refuses (usage) a path that ends in neither .ply nor .csv.
void check_spheres_path(const std::string& path);

// The spheres of a level at a pose, in world coordinates, with their state: 0 outside (grey), 1
// boundary (orange), 2 inside (red). A .ply holds points with radius and colour, a .csv the columns
// x,y,z,r,state.
void write_spheres(const std::string& path, std::span<const Sphere> spheres,
                   std::span<const SphereState> states, const Pose& pose);

}  // namespace vpm::tools
