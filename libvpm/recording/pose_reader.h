// Reads poses, a tool's or a camera's, from files and streams.
#pragma once

#include <array>
#include <cstddef>
#include <fstream>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/file/text.h"

namespace vpm {

// Returns seconds of a time that may count seconds, milli-, micro- or nanoseconds since 1970: 10^11
// s are the year 5138, and smaller ones are before 1973 in the next unit.
inline double seconds_of_stamp(double stamp) {
  if (stamp > 1e17) return 1e-9 * stamp;
  if (stamp > 1e14) return 1e-6 * stamp;
  return stamp > 1e11 ? 1e-3 * stamp : stamp;
}

// Order of the numbers in a file of poses, where a line of names tells it: columns, from 0.
struct PoseColumns {
  std::size_t count = 0;
  std::optional<std::size_t> time;
  bool has_nanoseconds = false;             // otherwise seconds_of_stamp() tells
  std::array<std::size_t, 3> position{};    // x, y, z
  std::array<std::size_t, 4> quaternion{};  // x, y, z, w
};

// Reads poses from a stream, one at a time, so that a pipe is answered line by line. Formats, told
// apart line by line:
//   JSON Lines   [tx,ty,tz,qx,qy,qz,qw], or {"pose": [7 numbers]}, or {"matrix": [16 numbers, row
//                by row]}; "time" in an object, or an eighth number in front, is the time
//   TUM text     "time tx ty tz qx qy qz qw" (the time may be left out)
//   4x4 text     four lines of four numbers for each pose
// A '#' starts a comment, except in a line of JSON. A line of names, in a comment or first in the
// file, tells the order of the numbers after it; otherwise quaternions end in w. Times may be
// seconds or whole milli-, micro- or nanoseconds since 1970.
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

// Returns the pose, camera to world, of a file that holds exactly one: in the formats of
// PoseReader, or a JSON object with "matrix", "transform_matrix", "camera_pose" or "pose" (4x4 by
// rows, flat or nested, or 7 numbers), or with "extrinsic" as Open3D writes it (world to camera, by
// columns), which is inverted. `deviation` as in rotation_from_quaternion. Throws Error(refused),
// naming the file, for any other.
Pose read_camera_pose(const std::string& path, double* deviation = nullptr);

}  // namespace vpm
