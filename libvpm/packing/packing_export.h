// Exports packings for other programs.
#pragma once

#include <string>
#include <vector>

#include "libvpm/model/sphere.h"

namespace vpm {

// File formats by extension of the path; lengths in metres.
//   .csv .ply .points.ply .glb   spheres (sphere_files.h), coloured by radius
//   .json        {"centers": [[x, y, z], ...], "radii": [r, ...]}, to the last bit
//   .vtk         legacy VTK: points with their radii
//   .yml .yaml   cuRobo's robot description: collision_spheres of a link
//   .urdf        a robot of one link whose collision geometry is the spheres
//   .srdf        link_sphere_approximation of a link
// Text has 9 significant digits, JSON as many as are exact. `link` names the link in YAML, URDF and
// SRDF. export_format throws Error(invalid_argument) for any other extension.
enum class ExportFormat { spheres, json, vtk, yml, urdf, srdf };
ExportFormat export_format(const std::string& path);

// Throws Error(invalid_argument) if the format cannot express the link's name: XML has no control
// characters but tabs and ends of lines.
void check_link(ExportFormat format, const std::string& link);

std::string packing_as_json(const std::vector<Sphere>& spheres);
std::string packing_as_vtk(const std::vector<Sphere>& spheres);
std::string packing_as_yml(const std::vector<Sphere>& spheres, const std::string& link);
// Throw as check_link does.
std::string packing_as_urdf(const std::vector<Sphere>& spheres, const std::string& link);
std::string packing_as_srdf(const std::vector<Sphere>& spheres, const std::string& link);

// Writes the file atomically. Throws Error(cannot_write), or as the functions above do.
void export_packing(const std::string& path, const std::vector<Sphere>& spheres,
                    const std::string& link);

}  // namespace vpm
