#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/model/tool_model.h"

namespace vpm {

// Reads a tool model from a file, from standard input ("-"), or from bytes. Throws Error(refused)
// if it breaks a rule of formats/tool-model.md.
ToolModel read_tool_model(const std::string& path);
ToolModel parse_tool_model(std::vector<std::byte> bytes, const std::string& name);

// Writes a tool model atomically, or to standard output ("-"). Throws Error(cannot_write).
void write_tool_model(const std::string& path, const ToolModel& model);

}  // namespace vpm
