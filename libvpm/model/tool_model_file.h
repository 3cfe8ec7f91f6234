#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Reads a tool model from a file, from standard input ("-"), or from bytes. Throws Error(refused)
// if it breaks a rule of formats/tool-model.md.
ToolModel read_tool_model(const std::string& path);
ToolModel parse_tool_model(std::vector<std::byte> bytes, const std::string& name);

// Reads the mesh that a tool model's file keeps for views; empty where it keeps none. No query
// needs it. Throws Error(refused) like read_tool_model.
Solid read_display_mesh(const std::string& path);

// Writes a tool model, and a mesh for views where there is one, atomically or to standard output
// ("-"). The mesh is kept in floats about the centre of mass. Throws Error(cannot_write).
void write_tool_model(const std::string& path, const ToolModel& model, const Solid& mesh = {});

}  // namespace vpm
