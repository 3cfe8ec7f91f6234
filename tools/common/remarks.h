// How the executables say what the library remarks.
#pragma once

#include <vpm/remark.h>

#include <string>

#include "tools/common/program.h"

namespace vpm::tools {

// Prints remarks about an input, each with its name.
inline void say(const Program& program, const std::string& name, const Remarks& remarks) {
  for (const Remark& remark : remarks)
    remark.is_warning ? program.warn(name + ": " + remark.text)
                      : program.note(name + ": " + remark.text);
}

}  // namespace vpm::tools
