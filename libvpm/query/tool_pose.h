// A pose of one of several tools, which are asked together.
#pragma once

#include <cstdint>

#include "libvpm/core/pose.h"

namespace vpm {

struct ToolPose {
  std::uint32_t tool = 0;  // its place among the tools
  Pose pose;
};

}  // namespace vpm
