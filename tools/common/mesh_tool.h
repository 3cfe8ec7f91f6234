// Tools of meshes, packed with spheres and built in memory.
#pragma once

#include <vpm/solid.h>
#include <vpm/tool.h>

#include <string>

#include "tools/common/program.h"

namespace vpm::tools {

// True if the file is a mesh that vpm-pack reads, by its content, or by the ending of its name
// where the content tells nothing. Standard input is none.
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

}  // namespace vpm::tools
