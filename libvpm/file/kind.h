// The kinds of vpm's files.
#pragma once

#include <cstdint>

namespace vpm::file {

// The numbers stand in the files (formats/container.md).
enum class Kind : std::uint32_t { packing = 1, tool_model = 2, cloud = 3 };

}  // namespace vpm::file
