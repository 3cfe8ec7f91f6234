// Takes numbers and texts from records and messages, and refuses what lies beyond their end.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "libvpm/core/error.h"

namespace vpm::mcap {

using Bytes = std::span<const std::byte>;

// Throws Error(refused), without a place and a hint, beyond the end of the bytes.
class ByteCursor {
 public:
  // Records of MCAP are little-endian and have no gaps.
  explicit ByteCursor(Bytes bytes) : bytes_(bytes) {}

  // Takes a message in the Common Data Representation of DDS (OMG), whose first bytes tell its
  // order of bytes: numbers are aligned to their size. Throws Error(refused) for others.
  static ByteCursor of_message(Bytes message) {
    constexpr std::array kZstd{std::byte{0x28}, std::byte{0xb5}, std::byte{0x2f}, std::byte{0xfd}};
    if (message.size() > kZstd.size() && std::ranges::equal(message.first(kZstd.size()), kZstd))
      refuse("its messages are compressed one by one, as rosbag2's compression mode 'message' does",
             {}, "rewrite its folder: rosbags-convert --src FOLDER --dst OUT --dst-storage mcap");
    if (message.size() < 4 || message[0] != std::byte{0} || message[1] > std::byte{1})
      refuse("a message is damaged, or not in the plain CDR of ROS 2");
    ByteCursor cursor(message.subspan(4));
    cursor.is_aligned_ = true;
    cursor.big_endian_ = message[1] == std::byte{0};
    return cursor;
  }

  template <class Number>
  Number number() {
    if (is_aligned_) take(std::min(left(), -at_ % sizeof(Number)));
    std::array<std::byte, sizeof(Number)> bytes;
    std::ranges::copy(take(sizeof(Number)), bytes.begin());
    if (big_endian_) std::ranges::reverse(bytes);
    return std::bit_cast<Number>(bytes);
  }

  // Takes a text behind its length, which in messages counts a 0 at its end.
  std::string text() {
    const Bytes bytes = take(number<std::uint32_t>());
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (is_aligned_ && text.ends_with('\0')) text.pop_back();
    return text;
  }

  Bytes take(std::uint64_t count) {
    if (count > left()) refuse("it is truncated or damaged");
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }

  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
  bool is_aligned_ = false, big_endian_ = false;
};

}  // namespace vpm::mcap
