// Words for what CLI11 refuses.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace vpm::tools {

// Returns the message of an option or configuration that is refused, `config` being the name of the
// configuration's file.
std::string message_of(const CLI::App& app, const CLI::ParseError& fault,
                       const std::string& config);

}  // namespace vpm::tools
