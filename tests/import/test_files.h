// Small files of other programs, made in memory.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vpm {

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

template <class Value>
void append(std::string& bytes, Value value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// Returns a PNG of one channel with `bits` 8 or 16, row by row.
std::string make_png(std::uint32_t width, std::uint32_t height, int bits,
                     const std::vector<std::uint16_t>& values, bool interlaced = false);

// Expects that every prefix of the file is refused with a message that begins with its name, and
// that every file with one damaged byte is read or refused. Checks about `samples` of each.
void expect_damage_is_refused(const std::string& file, std::size_t samples,
                              const std::function<void(std::span<const std::byte>)>& parse);

// True if the message contains the text.
::testing::AssertionResult says(const std::string& message, const std::string& text);

}  // namespace vpm
