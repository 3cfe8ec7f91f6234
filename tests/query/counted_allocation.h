// Whoever links this counts the memory that its process takes.
#pragma once

namespace vpm::testing {

// Calls of operator new so far.
int allocations();

}  // namespace vpm::testing
