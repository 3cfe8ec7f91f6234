#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/model/tool_model.h"

namespace vpm {

// Refuse (Error(refused)) whatever is not a sound file of this kind: see formats/. "-" is standard
// input.
ToolModel read_tool_model(const std::string& path);
ToolModel parse_tool_model(std::vector<std::byte> bytes, const std::string& name);

// Atomic; "-" is standard output. Throws Error(cannot_write).
void write_tool_model(const std::string& path, const ToolModel& model);

}  // namespace vpm
