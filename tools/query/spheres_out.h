// vpm-query --spheres-out: the spheres of a level with their states.
#pragma once

#include <span>
#include <string>

#include "libvpm/core/pose.h"
#include "libvpm/query/tool_query.h"

namespace vpm::tools {

// Throws Error(invalid_argument) if the path has none of the suffixes of formats/spheres.md.
void check_spheres_path(const std::string& path);

// Writes the spheres, which are in the tool's coordinates, at the pose in world coordinates, each
// with its state. The suffix chooses the format (formats/spheres.md).
void write_spheres(const std::string& path, std::span<const Sphere> spheres,
                   std::span<const SphereState> states, const Pose& pose);

}  // namespace vpm::tools
