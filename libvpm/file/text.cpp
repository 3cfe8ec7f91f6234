#include "libvpm/file/text.h"

#include <algorithm>

#include "libvpm/core/error.h"
#include "libvpm/core/number_list.h"

namespace vpm::file {
namespace {

char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool ends_first_line_in_cr(std::string_view text) {
  const std::size_t end = text.find_first_of("\r\n");
  return end != text.npos && text[end] == '\r' && text.substr(end + 1, 1) != "\n";
}

}  // namespace

std::vector<std::string_view> split_words(std::string_view line, std::string_view between) {
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(between); at != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(between, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(between, end);
  }
  return words;
}

std::optional<double> to_number(std::string_view word) {
  return number_from_text<double>(word);
}

std::optional<std::uint64_t> to_count(std::string_view word) {
  return number_from_text<std::uint64_t>(word);
}

std::string cure_of_number(std::string_view word) {
  // Some countries write decimals so, and some programs lists.
  if (word.find(',') == word.npos) return "";
  return "; decimals have a point, and numbers a blank between them";
}

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), lower_case);
  return lower;
}

bool is_word(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(),
                    [](char a, char b) { return lower_case(a) == b; });
}

std::string shown(std::string_view text, std::size_t most) {
  const auto goes_on = [&](std::size_t at) {  // as bytes within a character of UTF-8 do
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80;
  };
  std::size_t end = std::min(most, text.size());
  for (int k = 0; k < 3 && end > 0 && goes_on(end); ++k) --end;
  const std::string said = printable(std::string(text.substr(0, end)), 4 * most);
  return said + (text.size() > end ? "…" : "");
}

TextCursor::TextCursor(std::string_view text)
    : text_(text), ends_in_cr_(ends_first_line_in_cr(text)) {}

std::optional<std::string_view> TextCursor::line() {
  if (at_ == text_.size()) return std::nullopt;
  std::size_t end = at_;  // find_first_of would take several times as long
  while (end < text_.size() && text_[end] != '\n' && text_[end] != '\r') ++end;
  const std::string_view line = text_.substr(at_, end - at_);
  const bool is_pair = !ends_in_cr_ && text_.substr(end, 2) == "\r\n";
  at_ = std::min(end + (is_pair ? 2 : 1), text_.size());
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

void TextCursor::skip() {
  at_ = std::min(at_ + 1, text_.size());
}

std::optional<std::string> LineStream::next() {
  constexpr std::size_t kLongest = 1'000'000;  // bytes
  using Traits = std::istream::traits_type;
  std::string line;
  bool has_any = false;
  for (;;) {
    const auto character = stream_.get();
    if (Traits::eq_int_type(character, Traits::eof())) break;
    const char c = Traits::to_char_type(character);
    const bool is_pair = passes_over_lf_ && c == '\n';
    passes_over_lf_ = c == '\r';
    if (is_pair) continue;
    if (c == '\n' || c == '\r') return line;
    has_any = true;
    line += c;
    if (line.size() > kLongest) refuse("a line of more than a million bytes is no text");
  }
  return has_any ? std::optional(line) : std::nullopt;
}

}  // namespace vpm::file
