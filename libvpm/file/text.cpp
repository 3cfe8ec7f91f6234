#include "libvpm/file/text.h"

#include <algorithm>
#include <utility>

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

void append_utf8(char32_t code, std::string& text) {
  const auto add = [&](char32_t byte) { text += static_cast<char>(byte); };
  const auto rest = [&](unsigned shift) { add(0x80 | (code >> shift & 0x3F)); };
  if (code < 0x80) return add(code);
  if (code < 0x800) return add(0xC0 | code >> 6), rest(0);
  if (code < 0x10000) return add(0xE0 | code >> 12), rest(6), rest(0);
  add(0xF0 | code >> 18), rest(12), rest(6), rest(0);
}

}  // namespace

bool is_utf16(std::string_view text) {
  using namespace std::string_view_literals;
  if (text.starts_with("\xFF\xFE\0\0"sv)) return false;  // UTF-32
  return text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
}

std::string utf8_of(std::string_view text) {
  if (!is_utf16(text)) return std::string(text);
  const std::size_t high = text[0] == '\xFE' ? 0 : 1;  // place of the high byte of two
  const auto unit = [&](std::size_t at) -> char32_t {
    if (at + 2 > text.size()) return 0;
    return static_cast<unsigned char>(text[at + high]) * 256U +
           static_cast<unsigned char>(text[at + 1 - high]);
  };
  std::string utf8;
  for (std::size_t at = 2; at + 2 <= text.size(); at += 2) {
    char32_t code = unit(at);
    const char32_t next = unit(at + 2);
    if (code >= 0xD800 && code < 0xDC00 && next >= 0xDC00 && next < 0xE000) {
      code = 0x10000 + ((code - 0xD800) << 10) + (next - 0xDC00);
      at += 2;
    } else if (code >= 0xD800 && code < 0xE000) {  // half of a pair
      code = 0xFFFD;
    }
    append_utf8(code, utf8);
  }
  return utf8;
}

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

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 5;
  std::string list;
  for (std::size_t k = 0; k < std::min(kMost, names.size()); ++k)
    list += (k == 0 ? "" : ", ") + shown(names[k]);
  const std::size_t more = names.size() - std::min(kMost, names.size());
  return more == 0 ? list : list + " and " + std::to_string(more) + " more";
}

std::optional<std::uint64_t> number_in_name(const std::string& path) {
  constexpr std::string_view kDigits = "0123456789";
  const std::size_t begin = path.find_last_of('/') + 1;  // 0 without a folder
  const std::string_view stem = std::string_view(path).substr(begin, path.find('.', begin) - begin);
  const std::size_t last = stem.find_last_of(kDigits);
  if (last == stem.npos) return std::nullopt;
  const std::size_t first = stem.find_last_not_of(kDigits, last) + 1;
  return to_count(stem.substr(first, last - first + 1));
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

std::string rest_of(std::istream& stream) {
  constexpr std::size_t kMost = std::size_t{1} << 28U;  // bytes
  std::string text;
  char part[1U << 16U];
  while (stream.read(part, sizeof part), stream.gcount() > 0) {
    text.append(part, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kMost) refuse("more than 256 MB in one piece is not read");
  }
  return text;
}

void LineStream::begin() {
  has_begun_ = true;
  const int first = stream_->peek();
  if (first != 0xFF && first != 0xFE) return;
  utf8_.str(utf8_of(rest_of(*stream_)));
  stream_ = &utf8_;
}

bool LineStream::read_more() {
  if (std::istream::traits_type::eq_int_type(stream_->peek(), std::istream::traits_type::eof()))
    return false;
  ahead_.erase(0, std::exchange(at_, 0));
  const std::size_t before = ahead_.size();
  const std::streamsize there = std::max<std::streamsize>(stream_->rdbuf()->in_avail(), 1);
  ahead_.resize(before + static_cast<std::size_t>(there));
  stream_->read(ahead_.data() + before, there);
  return true;
}

std::optional<std::string> LineStream::next() {
  constexpr std::size_t kLongest = 1'000'000;  // bytes
  if (!has_begun_) begin();
  if (at_ == ahead_.size() && !read_more()) return std::nullopt;
  if (std::exchange(passes_over_lf_, false) && ahead_[at_] == '\n' && ++at_ == ahead_.size() &&
      !read_more())
    return std::nullopt;
  std::size_t size = 0;  // of the line, as far as it was searched
  for (;; ++size) {
    if (at_ + size == ahead_.size() && !read_more()) break;
    const char c = ahead_[at_ + size];
    if (c == '\n' || c == '\r') break;
    if (size == kLongest) refuse("a line of more than a million bytes is no text");
  }
  std::string line = ahead_.substr(at_, size);
  at_ += size;
  if (at_ < ahead_.size()) passes_over_lf_ = ahead_[at_++] == '\r';
  return line;
}

std::string LineStream::next_lines(bool may_wait) {
  constexpr std::size_t kLongest = std::size_t{1} << 16;  // bytes
  if (!has_begun_) begin();
  const auto can_read = [&] { return (!may_wait || has_more()) && read_more(); };
  if (passes_over_lf_) {
    if (at_ == ahead_.size() && !can_read()) return {};
    passes_over_lf_ = false;
    if (ahead_[at_] == '\n') ++at_;
  }
  for (std::size_t searched = 0; ahead_.find('\n', at_ + searched) == ahead_.npos;) {
    searched = ahead_.size() - at_;
    const bool ends_in_cr = ahead_.find('\r', at_) != ahead_.npos;
    if (ends_in_cr || searched > kLongest || !can_read()) return {};
  }
  if (may_wait && !has_more()) return {};
  const std::size_t end = ahead_.rfind('\n') + 1;
  const std::string_view lines = std::string_view(ahead_).substr(at_, end - at_);
  for (std::size_t k = 0; (k = lines.find('\r', k)) != lines.npos; ++k)
    if (lines[k + 1] != '\n') return {};
  at_ = end;
  return std::string(lines);
}

void LineStream::give_back(std::string_view lines) {
  ahead_.replace(0, std::exchange(at_, 0), lines);
}

std::size_t count_lines(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

}  // namespace vpm::file
