#include "libvpm/core/error.h"

#include <utility>

#include "libvpm/core/printable.h"

namespace vpm {
namespace {

constexpr std::size_t kLongest = 1000;  // bytes of a part

std::string message_of(const std::string& what, const std::string& where, const std::string& hint) {
  return (where.empty() ? "" : where + ": ") + what +
         (hint.empty() ? "" : (what.ends_with('.') ? " " : "; ") + hint);
}

}  // namespace

Error::Error(ErrorKind kind, const std::string& what, const std::string& where,
             const std::string& hint)
    : Error(kind, std::make_shared<const Parts>(Parts{printable(what, kLongest),
                                                      printable(where, kLongest),
                                                      printable(hint, kLongest)})) {}

Error::Error(ErrorKind kind, std::shared_ptr<const Parts> parts)
    : std::runtime_error(message_of(parts->problem, parts->where, parts->hint)),
      kind_(kind),
      parts_(std::move(parts)) {}

}  // namespace vpm
