#pragma once

#include <cstddef>
#include <span>

namespace vpm {

// Largest expansion by LZF: three bytes give up to 264.
inline constexpr std::size_t kMaxLzfRatio = 88;

// Decodes LZF (as in binary_compressed PCD) into `to`. Returns false for unsound data: a run or
// reference beyond either buffer, or a size other than to.size().
bool decode_lzf(std::span<const std::byte> from, std::span<std::byte> to);

}  // namespace vpm
