// Words for what CLI11 refuses.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>

namespace vpm::tools {

// Returns the message of an option or configuration that is refused. `config` names the
// configuration's file, empty if there is none, and `arguments` are the command line's.
std::string message_of(const CLI::App& app, const CLI::ParseError& fault, const std::string& config,
                       std::span<const char* const> arguments);

}  // namespace vpm::tools
