// Functions that run vpm-query in one of its modes: they write the results and all other outputs.
#pragma once

#include "tools/query/query_setup.h"

namespace vpm::tools {

// Runs the modes `poses` and `batches`.
void run_poses(QuerySetup& setup);
void run_coupling(QuerySetup& setup);
void run_frames(QuerySetup& setup);
void run_several_tools(QuerySetup& setup);

}  // namespace vpm::tools
