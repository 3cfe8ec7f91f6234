// Reads lines, words and numbers of text, and of text headers before binary data. Lines end in LF,
// CRLF or CR, also mixed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vpm::file {

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Returns the text without UTF-8's byte order mark, which some editors write first.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

inline constexpr std::string_view kBlank = " \t\r\n\v\f";
// Returns the words of the line, which one or several of the characters `between` stand between.
std::vector<std::string_view> split_words(std::string_view line, std::string_view between = kBlank);

// Returns the whole word as a number, by number_from_text(); empty if it is none.
std::optional<double> to_number(std::string_view word);
std::optional<std::uint64_t> to_count(std::string_view word);
// Returns what may be added to "is not a number": how to mend a decimal comma; often empty.
std::string cure_of_number(std::string_view word);

// Returns the text in lower case, of ASCII letters only.
std::string in_lower_case(std::string_view text);
// True if the text is this word, which is given in lower case, in letters of either case.
bool is_word(std::string_view text, std::string_view word);

// Returns the text as a message may show it, by printable(); what is beyond `most` bytes of it is
// replaced by "…".
std::string shown(std::string_view text, std::size_t most = 60);

// Reads a file in memory line by line or word by word. In a file whose first line ends in CR alone,
// an LF after a CR is not part of the line's end: it may be the first byte of binary data.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text);

  // Returns the next line without its end; empty at the end of the file.
  std::optional<std::string_view> line();
  // Returns the words of the next line that has any; none at the end of the file.
  std::vector<std::string_view> row();
  // Returns the next word across line ends; empty at the end of the file.
  std::string_view word();
  // Passes over one character, such as the blank between a header and binary data.
  void skip();

  std::size_t offset() const { return at_; }
  std::size_t remaining() const { return text_.size() - at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  bool ends_in_cr_ = false;  // the first line ends in CR alone
};

// Reads the lines of a stream as they come: a line is returned as soon as its end is read, so that
// a pipe is answered line by line.
class LineStream {
 public:
  // The stream must outlive this.
  explicit LineStream(std::istream& stream) : stream_(stream) {}

  // Returns the next line without its end; empty at the end of the stream. Throws Error(refused)
  // for a line of more than a million bytes, which no text has.
  std::optional<std::string> next();

 private:
  std::istream& stream_;
  bool passes_over_lf_ = false;  // the last line ended in CR
};

}  // namespace vpm::file
