// Makes texts fit for a terminal.
#pragma once

#include <cstddef>
#include <string>

namespace vpm {

// Returns the text on one line: control characters and bytes that are no UTF-8, which a file or a
// name may hold to steer a terminal, become \xNN, and what is beyond `most` bytes is replaced by
// "…", between two characters.
std::string printable(const std::string& text, std::size_t most);

}  // namespace vpm
