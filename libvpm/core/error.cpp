#include "libvpm/core/error.h"

#include <cstdio>
#include <utility>

namespace vpm {
namespace {

// True for characters of UTF-8 that steer a terminal or the order in which text is shown: U+0080 to
// U+009F, the marks and overrides of direction, breaks of lines, and halves of surrogate pairs or
// overlong forms, which are no characters.
bool steers_text(const std::string& character) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(character[k]); };
  switch (byte(0)) {
    case 0xC2:
      return byte(1) < 0xA0;
    case 0xD8:
      return byte(1) == 0x9C;  // U+061C
    case 0xE0:
      return byte(1) < 0xA0;
    case 0xE2:  // U+200E, U+200F, U+2028 to U+202E, U+2066 to U+2069
      return (byte(1) == 0x80 &&
              (byte(2) == 0x8E || byte(2) == 0x8F || (byte(2) >= 0xA8 && byte(2) <= 0xAE))) ||
             (byte(1) == 0x81 && byte(2) >= 0xA6 && byte(2) <= 0xA9);
    case 0xED:
      return byte(1) >= 0xA0;
    case 0xF0:
      return byte(1) < 0x90;
    case 0xF4:
      return byte(1) >= 0x90;
    default:
      return false;
  }
}

// Returns the bytes of the character at `at` if it is UTF-8 of more than one byte; 0 otherwise.
std::size_t multibyte_length(const std::string& text, std::size_t at) {
  const auto first = static_cast<unsigned char>(text[at]);
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || at + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((static_cast<unsigned char>(text[at + k]) & 0xC0) != 0x80) return 0;
  return steers_text(text.substr(at, length)) ? 0 : length;
}

constexpr std::size_t kLongest = 1000;  // bytes of a part

std::string message_of(const std::string& what, const std::string& where, const std::string& hint) {
  return (where.empty() ? "" : where + ": ") + what +
         (hint.empty() ? "" : (what.ends_with('.') ? " " : "; ") + hint);
}

}  // namespace

std::string printable(const std::string& text, std::size_t most) {
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    if (line.size() > most) return line + "…";
    const std::size_t length = multibyte_length(text, at);
    if (length > 0 || (text[at] >= ' ' && text[at] <= '~')) {
      line.append(text, at, length > 0 ? length : 1);
    } else {
      char code[5];
      std::snprintf(code, sizeof code, "\\x%02x", static_cast<unsigned char>(text[at]));
      line += code;
    }
    at += length > 0 ? length : 1;
  }
  return line;
}

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
