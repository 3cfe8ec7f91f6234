// vpm-query --pairs: which parts of an assembly share volume.
#pragma once

#include "tools/common/program.h"
#include "tools/query/arguments.h"

namespace vpm::tools {

// Measures all pairs of parts, and writes a line for each that shares volume. Ends the program with
// 10 if --fail-above is given and a pair shares more than that, or than it is allowed. Parts that
// are refused hide no pairs of others; unless there is such a pair, Error(refused) is thrown then,
// once all is written.
void run_pairs(Program& program, const Arguments& arguments);

}  // namespace vpm::tools
