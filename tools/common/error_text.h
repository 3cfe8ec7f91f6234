// How the executables say what the library throws.
#pragma once

#include <functional>
#include <string>

#include "libvpm/core/error.h"

namespace vpm::tools {

// Returns the exit code of an executable: 1 data refused, 2 wrong usage, 3 not there, 4 not
// written.
int exit_code(ErrorKind kind);

// Returns the library's text with the user's words for parameters and functions in backquotes:
// `max_hole` becomes --max-hole where has_option("--max-hole"), else the tool that has it is named.
std::string in_words_of_tools(const std::string& text,
                              const std::function<bool(const std::string&)>& has_option);

}  // namespace vpm::tools
