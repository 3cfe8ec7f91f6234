// Work dealt out to the blocks of a launch.
#pragma once

namespace vpm::cuda {

// Row k of the work goes to part k % parts.
struct Part {
  unsigned part = 0, parts = 1;
};

}  // namespace vpm::cuda
