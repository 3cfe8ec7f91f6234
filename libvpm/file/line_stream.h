// Reads lines of a stream as they come.
#pragma once

#include <istream>
#include <optional>
#include <string>

namespace vpm::file {

// Lines end in LF, CRLF or CR, also mixed. A line is returned as soon as its end is read, so that a
// pipe is answered line by line.
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
