// Reads a text file by lines and words, and knows its position for messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "libvpm/core/vec3.h"
#include "libvpm/file/text.h"

namespace vpm::file {

// Returns the text without the NULs and Ctrl-Zs at its end, and the blanks among them. Some
// programs pad files with NULs, and those of DOS mark the end of a text with Ctrl-Z.
std::string_view without_padding(std::string_view text);
// True if binary data may be followed by these bytes, which mean nothing: ends of lines and
// padding.
bool is_padding(std::string_view bytes);

// Throws Error(refused) if the header promises more than the file can hold: `least_bytes` for
// `what`.
void check_header_counts(const std::string& name, const std::string& what, double least_bytes,
                         std::size_t file_bytes);

// A character at the end of a line that goes on in the next one.
struct Continuation {
  char character = 0;  // 0 for formats without continued lines
  // Keywords whose lines may go on. Other lines may hold names that end in the character.
  std::span<const std::string_view> keywords;
};

// Bytes of a word of a file that messages show.
inline constexpr std::size_t kLongestShown = 40;

class TextLines {
 public:
  // Skips everything after `comment` on a line; 0 for formats without comments.
  TextLines(std::string_view text, std::string name, char comment, Continuation continuation = {});

  // Moves to the next line that has a word; false at the end of the text. Lines end in LF, CRLF or
  // CR (TextCursor).
  bool next_line();
  // Moves like next_line(), but throws Error(refused) at the end: "ends where <what> should
  // follow".
  void require_line(const char* what);
  // Lets words be taken across the ends of lines, or not.
  void cross_lines(bool crosses) { crosses_ = crosses; }

  // Returns the next word of this line; empty at its end.
  std::string_view word();
  double number(const char* what) { return to_number(word(), what); }
  std::int64_t integer(const char* what);
  // Returns three finite numbers.
  Vec3 point();
  // Returns the word as a number; throws Error(refused) if it is none.
  double to_number(std::string_view word, const char* what) const;

  // Returns what is left of this line, from its next word on.
  std::string_view rest() const { return rest_; }
  // Passes over `count` characters of the rest.
  void pass(std::size_t count);

  std::size_t line_number() const { return line_number_; }
  std::size_t offset() const { return cursor_.offset(); }  // position after this line
  [[noreturn]] void refuse_here(const std::string& defect) const;

 private:
  bool load_line();
  bool may_continue(std::string_view line) const;
  [[noreturn]] void refuse_missing(const char* what) const;

  TextCursor cursor_;
  std::string name_;
  char comment_;
  Continuation continuation_;
  bool continues_ = false;  // the line goes on in the next one
  bool crosses_ = false;
  std::size_t line_number_ = 0;
  std::string_view rest_;  // rest of the line
};

}  // namespace vpm::file
