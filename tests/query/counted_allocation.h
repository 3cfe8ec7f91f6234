// Counts the memory that the process of the linking program takes.
#pragma once

namespace vpm::testing {

// Returns the number of calls of operator new so far.
int allocations();

}  // namespace vpm::testing
