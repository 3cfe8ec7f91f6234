#pragma once

#include "libvpm/core/error.h"

namespace vpm::file {

// Failure to write because the reader of a pipe has gone: it wants no more, which is no mistake.
class ClosedPipe : public Error {
 public:
  explicit ClosedPipe(const std::string& what) : Error(ErrorKind::cannot_write, what) {}
};

}  // namespace vpm::file
