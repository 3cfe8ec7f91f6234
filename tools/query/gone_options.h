// Options that vpm-query no longer has.
#pragma once

#include "tools/common/tool.h"

namespace vpm::tools {

// Adds the options that earlier versions had; --help does not show them. Parsing one of them throws
// Error(invalid_argument) that says what to do instead.
void declare_gone_options(CLI::App& app);

}  // namespace vpm::tools
