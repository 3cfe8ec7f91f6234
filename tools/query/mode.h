// The ways to ask that vpm-query knows.
#pragma once

#include <cstddef>

#include "tools/query/arguments.h"

namespace vpm::tools {

// The table in option_rules.cpp has a column for each.
enum class Mode {
  poses,         // poses of one tool in a cloud, answered one by one
  batches,       // such poses, many answered at once
  coupling,      // path of a haptic device in a cloud
  frames,        // path through recorded frames, with or without a haptic device
  several_tools  // poses of several tools in a cloud, one by one or many at once
};
constexpr std::size_t kModes = 5;

// Returns the mode that the options choose.
Mode mode_of(const Arguments& arguments);

}  // namespace vpm::tools
