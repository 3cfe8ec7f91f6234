// Reads a text file by lines and words, and knows its position for messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "libvpm/core/vec3.h"

namespace vpm {

class TextLines {
 public:
  // Skips everything after `comment` on a line; 0 for formats without comments.
  TextLines(std::string_view text, std::string name, char comment);

  // Moves to the next line that has a word; false at the end of the text.
  bool next_line();
  // Moves like next_line(), but throws Error(refused) at the end: "ends where <what> should
  // follow".
  void require_line(const char* what);

  // Returns the next word of this line; empty at its end.
  std::string_view word();
  double number(const char* what);
  std::int64_t integer(const char* what);
  // Returns three finite numbers.
  Vec3 point();

  std::size_t line_number() const { return line_number_; }
  std::size_t offset() const { return at_; }  // position after this line
  [[noreturn]] void refuse_here(const std::string& defect) const;

 private:
  std::string_view text_;
  std::string name_;
  char comment_;
  std::size_t at_ = 0;
  std::size_t line_number_ = 0;
  std::string_view rest_;  // rest of the line
};

}  // namespace vpm
