// Runs work that may crash in a process of its own.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace vpm {

// Returns the bytes that `work` returns, called in a child process; nothing if the child crashed or
// ended without returning. What `work` writes to standard error is lost. It must not throw, start
// threads or wait for any: the child has none but the one that called. Throws Error(refused) if no
// process can be made.
std::optional<std::string> run_in_child(const std::function<std::string()>& work);

}  // namespace vpm
