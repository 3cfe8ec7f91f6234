// vpm-query --pairs: which parts of an assembly share volume.
#pragma once

#include "tools/common/program.h"
#include "tools/query/arguments.h"

namespace vpm::tools {

// Measures all pairs of an assembly's parts, and writes a line for each pair that shares volume.
// With
// --fail-above the program's exit status is 10 if a pair shares more than that, or more than the
// description allows it. A part that is refused is left out, and all other pairs are measured:
// Error(refused) is thrown when all is written, unless the exit status is 10.
void run_pairs(Program& program, const Arguments& arguments);

}  // namespace vpm::tools
