// Rules of which options of vpm-query go together. README.md tells users the same in its section
// "Which options go together"; the test page.vpm-query-options compares the two.
#pragma once

#include "tools/query/mode.h"

namespace vpm::tools {

// Throws Error(invalid_argument), naming the options, if one of those given does not go with the
// mode or with another one, or if one is missing. An option that has its default value counts as
// not given, since configurations that --dump-config writes name all options.
void check_options(const CLI::App& app, Mode mode);

}  // namespace vpm::tools
