#include "libvpm/mesh/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

std::string_view without_leading_blanks(std::string_view text) {
  std::size_t skip = 0;
  while (skip < text.size() && is_blank(text[skip])) ++skip;
  return text.substr(skip);
}

std::string quoted(std::string_view word) {
  constexpr std::size_t kLongestShown = 40;
  std::string shown;
  for (const char c : word.substr(0, kLongestShown)) shown += c >= ' ' && c <= '~' ? c : '?';
  return "'" + shown + (word.size() > kLongestShown ? "...'" : "'");
}

}  // namespace

TextLines::TextLines(std::string_view text, std::string name, char comment)
    : text_(text), name_(std::move(name)), comment_(comment) {}

bool TextLines::next_line() {
  while (at_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    ++line_number_;
    if (comment_ != 0) line = line.substr(0, line.find(comment_));
    rest_ = without_leading_blanks(line);
    if (!rest_.empty()) return true;
  }
  rest_ = {};
  return false;
}

void TextLines::require_line(const char* what) {
  if (!next_line()) {
    refuse("the file ends after line " + std::to_string(line_number_) + " where " + what +
               " should follow; it is truncated",
           name_);
  }
}

std::string_view TextLines::word() {
  std::size_t length = 0;
  while (length < rest_.size() && !is_blank(rest_[length])) ++length;
  const std::string_view found = rest_.substr(0, length);
  rest_ = without_leading_blanks(rest_.substr(length));
  return found;
}

double TextLines::number(const char* what) {
  std::string_view text = word();
  if (text.empty()) refuse_here(std::string(what) + " is missing");
  const std::string_view given = text;
  if (text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (stop != text.data() + text.size() || fault == std::errc::invalid_argument) {
    refuse_here(std::string(what) + " is " + quoted(given) + ", which is not a number");
  }
  // Beyond the range of doubles, strtod tells tiny numbers (rounded) from huge ones (infinite).
  if (fault == std::errc::result_out_of_range)
    value = std::strtod(std::string(text).c_str(), nullptr);
  return value;
}

std::int64_t TextLines::integer(const char* what) {
  std::string_view text = word();
  if (text.empty()) refuse_here(std::string(what) + " is missing");
  const std::string_view given = text;
  if (text.front() == '+') text.remove_prefix(1);
  std::int64_t value = 0;
  const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (stop != text.data() + text.size() || fault != std::errc()) {
    refuse_here(std::string(what) + " is " + quoted(given) + ", which is not a whole number" +
                (fault == std::errc::result_out_of_range ? " of 64 bits" : ""));
  }
  return value;
}

Vec3 TextLines::point() {
  Vec3 p;
  p.x = number("x");
  p.y = number("y");
  p.z = number("z");
  if (!is_finite(p)) refuse_here("a coordinate is not finite");
  return p;
}

void TextLines::refuse_here(const std::string& defect) const {
  refuse(defect, name_ + ": line " + std::to_string(line_number_));
}

}  // namespace vpm
