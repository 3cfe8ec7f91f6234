// Takes numbers and texts from records of MCAP and from messages of ROS 2, never beyond their end.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libvpm/core/error.h"

namespace vpm::mcap {

using Bytes = std::span<const std::byte>;

// Fault of a single record or message, which is left out and counted.
class Damage : public Error {
 public:
  explicit Damage(const std::string& what) : Error(ErrorKind::refused, what) {}
};

// Functions throw Damage where bytes are missing.
class ByteCursor {
 public:
  // Numbers of records are little-endian, without gaps between them.
  explicit ByteCursor(Bytes bytes) : bytes_(bytes) {}

  // Takes a message in the Common Data Representation of DDS (OMG): its first bytes tell the order
  // of bytes, and numbers are aligned to their size. Throws Damage for what is no such message.
  static ByteCursor of_message(Bytes message) {
    if (message.size() < 4 || message[0] != std::byte{0} || message[1] > std::byte{1})
      throw Damage("a message is not in the plain CDR of ROS 2");
    ByteCursor cursor(message.subspan(4));
    cursor.is_message_ = true;
    cursor.big_endian_ = message[1] == std::byte{0};
    return cursor;
  }

  template <class Number>
  Number number() {
    if (is_message_) take(std::min(left(), -at_ % sizeof(Number)));
    std::array<std::byte, sizeof(Number)> bytes;
    std::ranges::copy(take(sizeof(Number)), bytes.begin());
    if (big_endian_) std::ranges::reverse(bytes);
    return std::bit_cast<Number>(bytes);
  }

  // Takes so many doubles.
  std::vector<double> numbers(std::size_t count) {
    std::vector<double> numbers;
    while (numbers.size() < count) numbers.push_back(number<double>());
    return numbers;
  }

  // Takes what stands behind its length.
  Bytes data() { return take(number<std::uint32_t>()); }

  // Takes a text behind its length, which in messages counts the 0 at its end.
  std::string text() {
    const Bytes bytes = data();
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (is_message_ && text.ends_with('\0')) text.pop_back();
    return text;
  }

  Bytes take(std::uint64_t count) {
    if (count > left()) throw Damage("it is truncated or damaged");
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }

  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
  bool is_message_ = false, big_endian_ = false;
};

}  // namespace vpm::mcap
