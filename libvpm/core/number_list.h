// Parses numbers, and the lists of them that options and poses are written in.
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace vpm {

// Returns the word without a plus sign before its number, which std::from_chars() takes for no part
// of one.
inline std::string_view without_plus(std::string_view word) {
  return word.starts_with('+') && !word.starts_with("+-") ? word.substr(1) : word;
}

// Returns the word as a number, also "+1", "nan" and "inf"; nothing if any part of it is no number.
template <class Number>
std::optional<Number> number_from_text(std::string_view word) {
  word = without_plus(word);
  Number value{};
  const auto [stop, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || stop != word.data() + word.size()) return std::nullopt;
  return value;
}

// Returns the numbers of "1,2,3", "1 2 3" or "[1, 2, 3]". Throws Error(invalid_argument), naming
// the word at fault, if a word is no number, nothing stands between two commas, or a bracket is not
// closed or not opened.
std::vector<double> numbers_from_text(const std::string& text);

}  // namespace vpm
