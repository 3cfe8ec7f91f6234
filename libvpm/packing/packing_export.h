// Exports packings for other programs.
#pragma once

#include <string>
#include <vector>

#include "libvpm/model/sphere.h"

namespace vpm {

// The spheres of a link, in its frame, and those of a robot; of a single part, which is a robot of
// one link.
struct LinkSpheres {
  std::string link;
  std::vector<Sphere> spheres;
};
struct RobotSpheres {
  std::string robot;
  std::vector<LinkSpheres> links;
};

// Returns the number as text of nine digits, and the least number above it, or it, that such text
// has.
std::string digits(double value);
double rounded_up(double value);

// File formats by extension of the path; lengths in metres.
//   .csv .ply .points.ply .glb   spheres (sphere_files.h), coloured by radius
//   .json        {"centers": [[x, y, z], ...], "radii": [r, ...]}, to the last bit
//   .vtk         legacy VTK: points with their radii
//   .yml .yaml   cuRobo's robot description: collision_spheres of each link
//   .xrdf        the same spheres as a geometry of an XRDF, which its collision sections name
//   .urdf        a robot whose links' collision geometry is the spheres
//   .srdf        link_sphere_approximation of each link
// Text has 9 significant digits, JSON as many as are exact. The last four name links.
// export_format throws Error(invalid_argument) for any other extension.
enum class ExportFormat { spheres, json, vtk, yml, xrdf, urdf, srdf };
ExportFormat export_format(const std::string& path);
bool names_links(ExportFormat format);

// Throws Error(invalid_argument) if the format cannot express the link's name: XML has no control
// characters but tabs and ends of lines.
void check_link(ExportFormat format, const std::string& link);

std::string packing_as_json(const std::vector<Sphere>& spheres);
std::string packing_as_vtk(const std::vector<Sphere>& spheres);
std::string packing_as_yml(const RobotSpheres& robot);
std::string packing_as_xrdf(const RobotSpheres& robot);
// Throw as check_link does.
std::string packing_as_urdf(const RobotSpheres& robot);
std::string packing_as_srdf(const RobotSpheres& robot);
// Returns a line `link,x,y,z,r`, then one for each sphere; a link's name is quoted.
std::string robot_as_csv(const RobotSpheres& robot);

// Writes the file of a part atomically. Throws Error(cannot_write), or as the functions above do.
void export_packing(const std::string& path, const std::vector<Sphere>& spheres,
                    const std::string& link);

}  // namespace vpm
