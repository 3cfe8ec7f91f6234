// The ways to ask that vpm-query knows, and the options that go with each.
#pragma once

#include <cstddef>

#include "tools/query/arguments.h"
#include "tools/query/query_setup.h"

namespace vpm::tools {

// The table in mode.cpp has a column for each.
enum class Mode {
  poses,            // poses of one tool in a cloud, answered one by one
  batches,          // such poses, many answered at once
  coupling,         // path of a haptic device in a cloud
  frames,           // path through recorded frames, with or without a haptic device
  several_tools,    // poses of several tools in a cloud, one by one or many at once
  tools_in_frames,  // several tools through recorded frames, on one path or on one for each
  server,           // requests on standard input, answered line by line
  pairs,            // all pairs of an assembly's parts
  robot             // links of a robot at configurations of its joints
};
constexpr std::size_t kModes = 9;

// Returns the mode that the options choose.
Mode mode_of(const Arguments& arguments);

// Throws Error(invalid_argument), naming the options, if one of those given does not go with the
// mode or with another one, or if one is missing. An option that has its default value counts as
// not given, since configurations that --dump-config writes name all options. README.md tells users
// the same rules in its section "Which options go together"; the test page.vpm-query-options
// compares the two.
void check_options(const CLI::App& app, Mode mode);

// Run vpm-query in one of its modes: write the results and all other outputs. run_poses() runs the
// modes `poses` and `batches`.
void run_poses(QuerySetup& setup);
void run_coupling(QuerySetup& setup);
void run_frames(QuerySetup& setup);
void run_several_tools(QuerySetup& setup);
void run_server(QuerySetup& setup);
// Makes tools and setup itself, of a robot.
void run_robot(Program& program, const Arguments& arguments);

}  // namespace vpm::tools
