#include "libvpm/import/lzf.h"

#include <algorithm>

namespace vpm {

bool decode_lzf(std::span<const std::byte> from, std::span<std::byte> to) {
  constexpr std::size_t kLiteralLimit = 32;  // control bytes below it begin a run of literals
  constexpr std::size_t kLongLength = 7;     // a length that continues in another byte
  std::size_t in = 0, out = 0;
  while (in < from.size()) {
    const auto control = std::to_integer<std::size_t>(from[in++]);
    if (control < kLiteralLimit) {
      const std::size_t run = control + 1;
      if (run > from.size() - in || run > to.size() - out) return false;
      std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(in), run,
                  to.begin() + static_cast<std::ptrdiff_t>(out));
      in += run;
      out += run;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == kLongLength) {
      if (in == from.size()) return false;
      length += std::to_integer<std::size_t>(from[in++]);
    }
    length += 2;
    if (in == from.size()) return false;
    const std::size_t back = ((control & 31) << 8) + std::to_integer<std::size_t>(from[in++]) + 1;
    if (back > out || length > to.size() - out) return false;
    // Copies byte by byte, since a reference may overlap its output.
    for (std::size_t i = 0; i < length; ++i, ++out) to[out] = to[out - back];
  }
  return out == to.size();
}

}  // namespace vpm
