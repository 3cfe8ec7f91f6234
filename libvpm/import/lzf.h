#pragma once

#include <cstddef>
#include <span>

namespace vpm {

// Most bytes that one byte of LZF data can stand for: three bytes give up to 264.
inline constexpr std::size_t kMaxLzfRatio = 88;

// Decodes LZF (as in binary_compressed PCD) into `to`. False where the data is not sound: a run or
// a reference beyond either buffer, or a size that is not to.size() exactly.
bool decode_lzf(std::span<const std::byte> from, std::span<std::byte> to);

}  // namespace vpm
