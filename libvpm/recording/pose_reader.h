#pragma once

#include <cstddef>
#include <fstream>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"

namespace vpm {

// Poses from a stream, one at a time, so that a pipe is answered line by line. Each line tells what
// it is:
//   JSON Lines   [tx,ty,tz,qx,qy,qz,qw], or {"pose": [7 numbers]}, or {"matrix": [16 numbers, row
//                by row]}; "time" in an object, or an eighth number in front, is the time
//   TUM text     "time tx ty tz qx qy qz qw" (the time may be left out)
//   4x4 text     four lines of four numbers for each pose
// '#' begins a comment, but not within a line of JSON.
class PoseReader {
 public:
  explicit PoseReader(const std::string& path);  // "-" is standard input

  // The next pose; none at the end. Throws Error(refused) naming the line, or where the file cannot
  // be read on.
  std::optional<Pose> next();

  // Of the last pose, in seconds; none where its line has none.
  std::optional<double> time() const { return time_; }
  // Where the reader is, for messages.
  std::string place() const { return name_ + ", line " + std::to_string(line_); }
  // Says that there is no pose.
  [[noreturn]] void refuse_empty() const;

  // How far the worst rotation so far was from one before it was normalised.
  double largest_deviation() const { return largest_deviation_; }

 private:
  std::optional<std::string> next_line();
  Pose parse_json(const std::string& line);
  Pose parse_text(const std::string& line);
  Pose from_numbers(std::vector<double> numbers);  // a time may come first

  std::string name_;
  std::ifstream file_;
  std::istream& stream_;
  std::size_t line_ = 0;
  std::optional<double> time_;
  double largest_deviation_ = 0;
};

}  // namespace vpm
