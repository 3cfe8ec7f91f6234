#include "libvpm/core/error.h"

namespace vpm {

Error::Error(ErrorKind kind, const std::string& what, const std::string& where,
             const std::string& hint)
    : std::runtime_error((where.empty() ? "" : where + ": ") + what +
                         (hint.empty() ? "" : (what.ends_with('.') ? " " : "; ") + hint)),
      kind_(kind),
      parts_(std::make_shared<const Parts>(Parts{what, where, hint})) {}

}  // namespace vpm
