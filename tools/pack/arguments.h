// Options of vpm-pack, and what its ways to make spheres share.
#pragma once

#include <vpm/pose.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/mesh/mesh_check.h"
#include "tools/common/program.h"

namespace vpm::tools {

// Values of the options, in the units that --help names.
struct Arguments {
  std::string mesh, node, repair, output, report, link, for_scene, view;
  std::string urdf;  // in place of a mesh
  std::vector<std::string> exports, packages;
  std::size_t spheres = 1000;
  std::optional<std::size_t> robot_spheres;
  std::uint32_t level = 0;
  double coverage = 1, min_radius = 0, inflate = 0;
  std::optional<double> inertia_error, max_radius, weld, max_hole;
  double scale = 1;
  const CLI::Option* scale_option = nullptr;  // tells whether it was given
  bool grow = false, validate = false, outer = false;
};

SolidOptions solid_options(const Arguments& arguments);

// Returns the spheres with radii that are larger by --inflate.
std::vector<Sphere> inflated(const Arguments& arguments, std::vector<Sphere> spheres);

// Writes the spheres of a part to each --export.
void write_exports(const Arguments& arguments, const std::vector<Sphere>& spheres);

// Run vpm-pack for what is no mesh to be packed: export the spheres of a packing or tool model,
// hold a mesh by --outer, and pack a robot of --urdf. All but the last take the mesh's name.
void export_ready(const Program& program, const Arguments& arguments);
void run_outer(const Program& program, const Arguments& arguments, const CheckedSolid& checked);
void run_robot(const Program& program, const Arguments& arguments);

}  // namespace vpm::tools
