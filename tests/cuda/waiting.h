// What is asked of work on a device that is not done yet.
#pragma once

namespace vpm::testing {

struct Asked {
  bool was_done;     // an event behind a kernel that waits
  bool left_error;   // for the next launch to find
  bool is_done_now;  // when the kernel has been let go
};
Asked ask_while_a_kernel_waits();

}  // namespace vpm::testing
