// Packings for other programs.
#pragma once

#include <string>
#include <vector>

#include "libvpm/model/sphere.h"

namespace vpm {

// By the extension of the path:
//   .csv  a line "x,y,z,r", then one line of 9 significant digits per sphere, metres
//   .ply  every sphere as an icosphere of 80 triangles, coloured by its radius from blue (smallest)
//         to red (largest, logarithmic); binary, for viewers
//   .yml  collision_spheres of a robot description of cuRobo; `link` names the link
// Any other name throws Error(usage).
enum class ExportFormat { csv, ply, yml };
ExportFormat export_format(const std::string& path);

std::string packing_as_csv(const std::vector<Sphere>& spheres);
std::string packing_as_ply(const std::vector<Sphere>& spheres);
std::string packing_as_yml(const std::vector<Sphere>& spheres, const std::string& link);

// Atomic; throws Error(cannot_write).
void export_packing(const std::string& path, const std::vector<Sphere>& spheres,
                    const std::string& link);

}  // namespace vpm
