// Tools of meshes, packed with spheres and built in memory.
#pragma once

#include <vpm/robot.h>
#include <vpm/solid.h>
#include <vpm/tool.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/common/program.h"

namespace vpm::tools {

// True if the file is a mesh that vpm-pack reads, by the ending of its name, or by its content, of
// which PLY may also be points. Standard input is none.
bool is_mesh_file(const std::string& path);

// True if a file of this name is a mesh that vpm-pack reads, by its ending.
bool has_mesh_ending(const std::string& path);

// Returns a function of the library that reads meshes (mesh_plugin.h), which is loaded for the
// first one. Throws Error(unavailable) where it is not built.
void* function_of_meshes(const char* name);

// Returns the tool of a mesh: that of `vpm-pack MESH --spheres 1000` and `vpm-graph`. Says what
// they say of the mesh, and how to keep the tool. Throws what these refuse, and Error(unavailable)
// where they are not built.
Tool tool_of_mesh(const Program& program, const std::string& path);

// Returns the solid of a mesh, prepared `with_force` for what forces need, too. Says and throws the
// same.
SolidBody solid_of_mesh(const Program& program, const std::string& path, bool with_force);

// A robot, and the pairs of its links that are not asked whether they share volume.
struct RobotOfFiles {
  Robot robot;
  std::vector<std::array<std::size_t, 2>> ignored;
};

// Reads a robot and its SRDF, if that is not empty, and says what it lets doubt. Throws what
// read_robot() and ignored_pairs() do, and Error(unavailable) where they are not built.
RobotOfFiles read_robot_files(const Program& program, const std::string& urdf,
                              const RobotOptions& options, const std::string& srdf);

struct LinkBodies {
  SolidBody solid;
  std::optional<Tool> tool;
};

// Returns the solid of a link, prepared `with_force` for what forces need, too, and, if `spheres`
// is not 0, its tool of that many spheres. Says what is said of its mesh.
LinkBodies bodies_of_link(const Program& program, const Robot& robot, std::size_t link,
                          bool with_force, unsigned spheres);

}  // namespace vpm::tools
