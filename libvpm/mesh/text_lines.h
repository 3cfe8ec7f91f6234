// Walks the lines of a text file word by word and knows where it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "libvpm/core/vec3.h"

namespace vpm {

class TextLines {
 public:
  // Everything after `comment` on a line is skipped; 0 for formats without comments.
  TextLines(std::string_view text, std::string name, char comment);

  // Goes to the next line that holds a word; false at the end of the text.
  bool next_line();
  // As next_line, but refuses the end of the text: "ends where <what> should follow".
  void require_line(const char* what);

  std::string_view word();  // the next of this line; empty at its end
  double number(const char* what);
  std::int64_t integer(const char* what);
  Vec3 point();  // three numbers, all finite

  std::size_t line_number() const { return line_number_; }
  std::size_t offset() const { return at_; }  // of the first byte after this line
  [[noreturn]] void refuse_here(const std::string& defect) const;

 private:
  std::string_view text_;
  std::string name_;
  char comment_;
  std::size_t at_ = 0;
  std::size_t line_number_ = 0;
  std::string_view rest_;  // of the line
};

}  // namespace vpm
