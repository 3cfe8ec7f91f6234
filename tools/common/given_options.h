#pragma once

#include <CLI/CLI.hpp>

namespace vpm::tools {

// True if the option has a value other than its default, which configurations that --dump-config
// writes name, too.
bool is_given(const CLI::App& app, const char* name);

}  // namespace vpm::tools
