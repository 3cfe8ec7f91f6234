// Reads lines, words and numbers of text, and of text headers before binary data. Lines end in LF,
// CRLF or CR, also mixed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <span>
#include <sstream>
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

// True if the text begins with the mark of UTF-16, of either order of bytes.
bool is_utf16(std::string_view text);
// Returns a text in UTF-16, which begins with its mark, in UTF-8, and any other as it is. What is
// no character becomes U+FFFD.
std::string utf8_of(std::string_view text);

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

// Returns the names as a message lists them: five at most, then how many more there are.
std::string listed(const std::vector<std::string>& names);

// Returns the last number in a file's name before its first dot: 460 for frame-000460.depth.png.
std::optional<std::uint64_t> number_in_name(const std::string& path);

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

// Returns what is left of a stream. Throws Error(refused) for more than 256 MB.
std::string rest_of(std::istream& stream);

// Returns the number of lines in a text whose lines all end in LF.
std::size_t count_lines(std::string_view text);

// Reads the lines of a stream as they come: a line is returned as soon as its end is read, so that
// a pipe is answered line by line. Reads ahead what is there. Of a stream in UTF-16, which begins
// with its mark, all is read at once, and lines are in UTF-8.
class LineStream {
 public:
  // The stream must outlive this.
  explicit LineStream(std::istream& stream) : stream_(&stream) {}

  // Returns the next line without its end; empty at the end of the stream. Throws Error(refused)
  // for a line of more than a million bytes, which no text has.
  std::optional<std::string> next();

  // Returns the next whole lines that are there, with their ends. Returns "" where next() is to be
  // asked instead: before a line that does not end in LF or CRLF, or is longer than a block, and at
  // the end. Of a stream that one `may_wait` for, such as a pipe, returns lines only if there is
  // more after them, so that the next call need not wait.
  std::string next_lines(bool may_wait);
  // Takes back the last lines that next_lines() returned.
  void give_back(std::string_view lines);

 private:
  // Replaces a stream in UTF-16 by its text in UTF-8.
  void begin();
  // Reads what is there, and waits for the first byte; false at the end of the stream.
  bool read_more();
  // True if there is something to read.
  bool has_more() const { return stream_->rdbuf()->in_avail() > 0; }

  std::istream* stream_;
  std::istringstream utf8_;
  std::string ahead_;   // has been read
  std::size_t at_ = 0;  // what of it was returned
  bool has_begun_ = false;
  bool passes_over_lf_ = false;  // the last line ended in CR
};

}  // namespace vpm::file
