// Refuses handles of the public headers that were moved from, with one message for all of them.
#pragma once

#include <string>

#include "libvpm/core/error.h"

namespace vpm {

// Returns what a handle's pointer points to. Throws Error(invalid_argument) where that is null,
// which means that the handle, of the type `name`, was moved from.
template <class Pointer>
auto& held_by(const Pointer& pointer, const char* name) {
  if (pointer == nullptr)
    throw Error(ErrorKind::invalid_argument, std::string("a moved-from ") + name + " is used", {},
                "use the one that it was moved to");
  return *pointer;
}

}  // namespace vpm
