// Makes texts fit for a terminal.
#pragma once

#include <string>

namespace vpm::tools {

// Returns the text on one line: control characters and bytes that are no UTF-8 become \xNN, and
// what is beyond 2000 bytes is replaced by "…".
std::string on_one_line(const std::string& text);

}  // namespace vpm::tools
