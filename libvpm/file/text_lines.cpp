#include "libvpm/file/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/core/number_list.h"

namespace vpm::file {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

std::string_view without_leading_blanks(std::string_view text) {
  std::size_t skip = 0;
  while (skip < text.size() && is_blank(text[skip])) ++skip;
  return text.substr(skip);
}

std::string_view without_trailing_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view first_word(std::string_view line) {
  return line.substr(
      0, static_cast<std::size_t>(std::find_if(line.begin(), line.end(), is_blank) - line.begin()));
}

std::string quoted(std::string_view word) {
  return "'" + shown(word, kLongestShown) + "'";
}

}  // namespace

std::string_view without_padding(std::string_view text) {
  constexpr std::string_view kPadding("\0\x1a", 2), kPaddingOrBlank("\0\x1a \t\r\n\v\f", 8);
  const std::size_t last = text.find_last_not_of(kPaddingOrBlank);
  const std::size_t end = last == text.npos ? 0 : last + 1;
  return text.substr(0, text.find_first_of(kPadding, end));
}

bool is_padding(std::string_view bytes) {
  constexpr std::string_view kPadding("\0\x1a\r\n", 4);
  return bytes.find_first_not_of(kPadding) == bytes.npos;
}

void check_header_counts(const std::string& name, const std::string& what, double least_bytes,
                         std::size_t file_bytes) {
  if (least_bytes > static_cast<double>(file_bytes)) {
    refuse("the header says " + what + ", but the file has only " + std::to_string(file_bytes) +
               " bytes; it is truncated or damaged",
           name);
  }
}

TextLines::TextLines(std::string_view text, std::string name, char comment,
                     Continuation continuation)
    : cursor_(text), name_(std::move(name)), comment_(comment), continuation_(continuation) {}

bool TextLines::load_line() {
  const std::optional<std::string_view> line = cursor_.line();
  const bool is_continued = std::exchange(continues_, false);
  rest_ = {};
  if (!line) return false;
  ++line_number_;
  std::string_view text = comment_ == 0 ? *line : line->substr(0, line->find(comment_));
  text = without_leading_blanks(text);
  if (continuation_.character != 0) {
    const std::string_view trimmed = without_trailing_blanks(text);
    if (trimmed.ends_with(continuation_.character)) {
      const std::string_view before = trimmed.substr(0, trimmed.size() - 1);
      continues_ = is_continued || may_continue(before);
      if (continues_) text = before;
    }
  }
  rest_ = text;
  return true;
}

bool TextLines::may_continue(std::string_view line) const {
  const std::string_view keyword = first_word(line);
  return keyword.empty() ||
         std::ranges::find(continuation_.keywords, keyword) != continuation_.keywords.end();
}

bool TextLines::next_line() {
  while (continues_ && load_line()) {
  }
  while (load_line())
    if (!rest_.empty() || continues_) return true;
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
  while (rest_.empty()) {
    if (continues_ ? !load_line() : !(crosses_ && next_line())) return {};
  }
  std::size_t length = 0;
  while (length < rest_.size() && !is_blank(rest_[length])) ++length;
  const std::string_view found = rest_.substr(0, length);
  pass(length);
  return found;
}

void TextLines::pass(std::size_t count) {
  rest_ = without_leading_blanks(rest_.substr(count));
}

double TextLines::to_number(std::string_view given, const char* what) const {
  if (given.empty()) refuse_missing(what);
  const std::string_view text = without_plus(given);
  double value = 0;
  const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (stop != text.data() + text.size() || fault == std::errc::invalid_argument) {
    refuse_here(std::string(what) + " is " + quoted(given) + ", which is not a number" +
                cure_of_number(given));
  }
  // Beyond the range of doubles, strtod tells tiny numbers (rounded) from huge ones (infinite).
  if (fault == std::errc::result_out_of_range)
    value = std::strtod(std::string(text).c_str(), nullptr);
  return value;
}

std::int64_t TextLines::integer(const char* what) {
  const std::string_view given = word();
  if (given.empty()) refuse_missing(what);
  const std::string_view text = without_plus(given);
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

void TextLines::refuse_missing(const char* what) const {
  if (!crosses_) refuse_here(std::string(what) + " is missing");
  refuse("the file ends after line " + std::to_string(line_number_) + " where " + what +
             " should follow; it is truncated",
         name_);
}

void TextLines::refuse_here(const std::string& defect) const {
  refuse(defect, name_ + ": line " + std::to_string(line_number_));
}

}  // namespace vpm::file
