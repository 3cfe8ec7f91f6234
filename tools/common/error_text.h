// How the executables say what the library throws.
#pragma once

#include <vpm/error.h>

#include <functional>
#include <string>

namespace vpm::tools {

// Returns the exit code of an executable: 1 data refused, 2 wrong usage, 3 not there, 4 not
// written.
int exit_code(ErrorKind kind);

// Throws Error(invalid_argument): the options are at fault, not the data.
[[noreturn]] inline void refuse_usage(const std::string& message) {
  throw Error(ErrorKind::invalid_argument, message);
}

// Returns what the action returns. Errors that it throws are about `what`, the value of an option
// or a file.
template <class Action>
auto naming(const std::string& what, const Action& action) {
  try {
    return action();
  } catch (const Error& fault) {
    throw Error(fault.kind(), fault.problem(), what, fault.hint());
  }
}

// Returns the library's text with the user's words for parameters and functions in backquotes:
// `max_hole` becomes --max-hole where has_option("--max-hole"), else the tool that has it is named.
std::string in_words_of_tools(const std::string& text,
                              const std::function<bool(const std::string&)>& has_option);

}  // namespace vpm::tools
