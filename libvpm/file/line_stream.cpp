#include "libvpm/file/line_stream.h"

#include "libvpm/core/error.h"

namespace vpm::file {

std::optional<std::string> LineStream::next() {
  constexpr std::size_t kLongest = 1'000'000;  // bytes
  using Traits = std::istream::traits_type;
  std::string line;
  bool has_any = false;
  for (;;) {
    const auto character = stream_.get();
    if (Traits::eq_int_type(character, Traits::eof())) break;
    const char c = Traits::to_char_type(character);
    const bool is_pair = passes_over_lf_ && c == '\n';
    passes_over_lf_ = c == '\r';
    if (is_pair) continue;
    if (c == '\n' || c == '\r') return line;
    has_any = true;
    line += c;
    if (line.size() > kLongest) refuse("a line of more than a million bytes is no text");
  }
  return has_any ? std::optional(line) : std::nullopt;
}

}  // namespace vpm::file
