// Errors (vpm/error.h), and the shortest way to throw the most frequent one.
#pragma once

#include <string>

#include "libvpm/include/vpm/error.h"

namespace vpm {

// Throws Error(refused).
[[noreturn]] inline void refuse(const std::string& what, const std::string& where = {},
                                const std::string& hint = {}) {
  throw Error(ErrorKind::refused, what, where, hint);
}

}  // namespace vpm
