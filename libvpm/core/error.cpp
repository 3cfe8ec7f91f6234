#include "libvpm/core/error.h"

#include <cstdio>

namespace vpm {
namespace {

constexpr std::size_t kLongest = 1000;  // bytes of a text

// Returns the text without what a file or a name may have put into it to steer a terminal: control
// characters become \xNN. Cuts it, between characters of UTF-8, if it is long.
std::string as_shown(const std::string& text) {
  std::string shown;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_inside_character = (byte & 0xC0) == 0x80;
    if (shown.size() > kLongest && !is_inside_character) return shown + "…";
    if (byte < ' ' || byte == 0x7f) {
      char code[5];
      std::snprintf(code, sizeof code, "\\x%02x", byte);
      shown += code;
    } else {
      shown += c;
    }
  }
  return shown;
}

std::string message_of(const std::string& what, const std::string& where, const std::string& hint) {
  return (where.empty() ? "" : where + ": ") + what +
         (hint.empty() ? "" : (what.ends_with('.') ? " " : "; ") + hint);
}

}  // namespace

Error::Error(ErrorKind kind, const std::string& what, const std::string& where,
             const std::string& hint)
    : std::runtime_error(message_of(as_shown(what), as_shown(where), as_shown(hint))),
      kind_(kind),
      parts_(
          std::make_shared<const Parts>(Parts{as_shown(what), as_shown(where), as_shown(hint)})) {}

}  // namespace vpm
