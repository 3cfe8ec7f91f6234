#pragma once

#include <cstddef>
#include <fstream>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/file/line_stream.h"
#include "libvpm/recording/pose_columns.h"

namespace vpm {

// Reads poses from a stream, one at a time, so that a pipe is answered line by line. Formats, told
// apart line by line:
//   JSON Lines   [tx,ty,tz,qx,qy,qz,qw], or {"pose": [7 numbers]}, or {"matrix": [16 numbers, row
//                by row]}; "time" in an object, or an eighth number in front, is the time
//   TUM text     "time tx ty tz qx qy qz qw" (the time may be left out)
//   4x4 text     four lines of four numbers for each pose
// A '#' starts a comment, except in a line of JSON. A line of names, in a comment or first in the
// file, tells the order of the numbers after it (pose_columns.h); otherwise quaternions end in w.
// Times may be seconds or whole milli-, micro- or nanoseconds since 1970 (time_stamp.h).
class PoseReader {
 public:
  explicit PoseReader(const std::string& path);  // "-" reads standard input

  // Returns the next pose; empty at the end. Throws Error(refused), naming the line, if it is no
  // pose or the file cannot be read.
  std::optional<Pose> next();

  // Returns the time of the last pose in seconds; empty if its line has none.
  std::optional<double> time() const { return time_; }
  // Returns the name and line of the last pose, for messages.
  std::string place() const { return name_ + ", line " + std::to_string(line_); }
  // Throws Error(refused) that there is no pose.
  [[noreturn]] void refuse_empty() const;

  // Returns the largest deviation of a rotation before it was normalised.
  double largest_deviation() const { return largest_deviation_; }

 private:
  std::optional<std::string> next_line();
  // Returns the next line; empty at the end. Throws Error(refused), naming it, if it is no text.
  std::optional<std::string> any_line();
  Pose parse_json(const std::string& line);
  Pose parse_text(const std::string& line);
  // Takes 7 numbers, or 8 with the time first.
  Pose from_numbers(std::vector<double> numbers);

  std::string name_;
  std::ifstream file_;
  std::istream& stream_;
  file::LineStream lines_;
  std::optional<PoseColumns> columns_;
  std::size_t line_ = 0;
  std::optional<double> time_;
  double largest_deviation_ = 0;
};

}  // namespace vpm
