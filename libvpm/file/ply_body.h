// Reads the elements of a PLY file after its header, one record after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libvpm/file/ply_header.h"
#include "libvpm/file/text_lines.h"

namespace vpm::file {

// Every record stands between begin_record() and end_record(), and each of its properties is read
// or skipped in order. All throw Error(refused), naming `name` and the line or byte, where the file
// ends, or holds what is no number. Not thread-safe.
class PlyBody {
 public:
  // `bytes` is the whole file; it, the header and the name must outlive this.
  PlyBody(std::string_view bytes, const PlyHeader& header, const std::string& name);

  void begin_record();
  void end_record();
  double value(ScalarType type);
  // Returns the number of values of a list, of which the file has as many, if it is binary.
  std::uint64_t length(const PlyProperty& list);
  void skip(const PlyProperty& property);

  // Says what the file holds that its header does not count, after the last record was read: longer
  // lines, another PLY file, more bytes.
  std::vector<std::string> unread();
  [[noreturn]] void refuse_here(const std::string& defect) const;

 private:
  bool is_text() const { return header_.encoding == PlyEncoding::text; }
  std::string place() const;
  std::string_view rest();

  std::string_view bytes_;
  const PlyHeader& header_;
  const std::string& name_;
  std::size_t at_;                             // position in a binary file
  TextLines lines_;                            // position in a text
  std::size_t longer_ = 0, first_longer_ = 0;  // lines that hold more than a record
};

}  // namespace vpm::file
