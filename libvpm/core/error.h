// Errors (vpm/error.h), the shortest way to throw the most frequent one, and texts fit for a
// terminal.
#pragma once

#include <vpm/error.h>

#include <cstddef>
#include <string>

namespace vpm {

// Throws Error(refused).
[[noreturn]] inline void refuse(const std::string& what, const std::string& where = {},
                                const std::string& hint = {}) {
  throw Error(ErrorKind::refused, what, where, hint);
}

// Returns the text on one line: control characters, those that turn the direction of text, and
// bytes that are no UTF-8, which a file or a name may hold to steer a terminal, become \xNN, and
// what is beyond `most` bytes is replaced by "…", between two characters.
std::string printable(const std::string& text, std::size_t most);

}  // namespace vpm
