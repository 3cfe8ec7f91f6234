#include "libvpm/import/file_text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>

namespace vpm {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kBlank = " \t\r\n\v\f";

template <class Number>
std::optional<Number> parse(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  Number value{};
  const auto [stop, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || stop != word.data() + word.size()) return std::nullopt;
  return value;
}

template <class Value>
double as_double(const std::array<std::byte, 8>& bytes) {
  Value value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return static_cast<double>(value);
}

}  // namespace

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  TextCursor cursor(line);
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word())
    words.push_back(word);
  return words;
}

std::optional<double> to_number(std::string_view word) {
  return parse<double>(word);
}

std::optional<std::uint64_t> to_count(std::string_view word) {
  return parse<std::uint64_t>(word);
}

std::optional<std::string_view> TextCursor::line() {
  if (at_ == text_.size()) return std::nullopt;
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view line = text_.substr(at_, end - at_);
  at_ = std::min(end + 1, text_.size());
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> TextCursor::row() {
  std::vector<std::string_view> words;
  while (words.empty()) {
    const std::optional<std::string_view> next = line();
    if (!next) break;
    words = split_words(*next);
  }
  return words;
}

std::string_view TextCursor::word() {
  const std::size_t begin = std::min(text_.find_first_not_of(kBlank, at_), text_.size());
  at_ = std::min(text_.find_first_of(kBlank, begin), text_.size());
  return text_.substr(begin, at_ - begin);
}

bool is_known(ScalarType type) {
  const int size = type.size;
  if (type.kind == 'F') return size == 4 || size == 8;
  return (type.kind == 'I' || type.kind == 'U') &&
         (size == 1 || size == 2 || size == 4 || size == 8);
}

double read_scalar(const std::byte* from, ScalarType type, bool big_endian) {
  std::array<std::byte, 8> bytes{};
  std::copy_n(from, type.size, bytes.begin());
  if (big_endian) std::reverse(bytes.begin(), bytes.begin() + type.size);
  if (type.kind == 'F') return type.size == 4 ? as_double<float>(bytes) : as_double<double>(bytes);
  const bool is_signed = type.kind == 'I';
  switch (type.size) {
    case 1:
      return is_signed ? as_double<std::int8_t>(bytes) : as_double<std::uint8_t>(bytes);
    case 2:
      return is_signed ? as_double<std::int16_t>(bytes) : as_double<std::uint16_t>(bytes);
    case 4:
      return is_signed ? as_double<std::int32_t>(bytes) : as_double<std::uint32_t>(bytes);
    default:
      return is_signed ? as_double<std::int64_t>(bytes) : as_double<std::uint64_t>(bytes);
  }
}

}  // namespace vpm
