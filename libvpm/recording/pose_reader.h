// Reads poses, a tool's or a camera's, from files and streams.
#pragma once

#include <cstddef>
#include <fstream>
#include <istream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/file/npy.h"
#include "libvpm/file/text.h"
#include "libvpm/import/remark.h"
#include "libvpm/recording/mcap/ros_recording.h"
#include "libvpm/recording/pose_parser.h"

namespace vpm {

// Lines of a file, each with its end, and what understands those of them that are plain.
struct PoseLines {
  std::string text;
  std::size_t count = 0;
  PoseParser parser;
};

// Reads poses from a stream, one at a time, so that a pipe is answered line by line. Formats, told
// apart line by line:
//   JSON         [tx,ty,tz,qx,qy,qz,qw], or {"pose": [7 numbers]}, or {"matrix": [16 numbers, row
//                by row]}, or {"position": {x, y, z}, "orientation": {x, y, z, w}}, or {"tool": one
//                of these}; "time", "timestamp", "stamp" or "t" in an object, or an eighth number
//                in front, is the time; "id" in an object is kept, and "solids", a list of poses.
//                Also as numpy prints lists, over several lines, and a list of such poses
//   TUM text     "time tx ty tz qx qy qz qw" (the time may be left out)
//   KITTI text   twelve numbers, a 3x4 matrix row by row
//   matrix text  four lines of four numbers for each pose, or three for each pose of the file
//   NPY          an array of matrices, N x 4 x 4 or N x 3 x 4, or of N x 7 numbers, or 8 with the
//                time first
//   MCAP         poses in a recording of ROS 2, as ros_recording.h names them: "rec.mcap:/topic"
// Texts are in UTF-8, or in UTF-16 with its mark. A '#' starts a comment, except in a line of JSON.
// A line of names, in a comment or first in the file, tells the order of the numbers after it;
// otherwise quaternions end in w. Words beside the names are passed over; a comment that seems to
// tell another order, but not clearly, is refused with the first pose that has a quaternion. Times
// may be seconds or whole milli-, micro- or nanoseconds since 1970.
class PoseReader {
 public:
  explicit PoseReader(const std::string& path);  // "-" reads standard input

  // Returns the next pose; empty at the end. Throws Error(refused), naming the line, if it is no
  // pose or the file cannot be read.
  std::optional<Pose> next();

  // Returns the lines after the last pose that are there, so that other threads may understand
  // them. Empty where only next() can go on: at the end, before the first pose, within a list or an
  // array, before a line that is long or does not end in LF, and where one would have to wait for
  // the lines or what comes after them. Throws Error(refused) if the file cannot be read.
  std::optional<PoseLines> next_lines();
  // Takes back the last lines that next_lines() returned, from the first one on that is not plain:
  // next() goes on there.
  void give_back(std::string_view lines);
  // True if next() has a pose without reading on: one of a list or an array.
  bool has_more() const;

  // Returns the value of `id` beside the last pose in an object of JSON, as JSON; empty if it has
  // none.
  const std::string& id() const { return last_.id; }
  // Returns the poses in "solids" beside the last pose; empty if it has none.
  const std::vector<Pose>& solids() const { return last_.solids; }
  // Returns the time of the last pose in seconds; empty if its line has none.
  std::optional<double> time() const { return last_.time; }
  // True if the last line that was read has numbers that are not finite, or only zeros, which
  // trackers write where they are lost. Also after next() has refused it.
  bool is_undefined() const { return parser_.is_undefined(); }
  // Returns the path, and of MCAP the frame that the poses are in, and what is said of the file.
  const std::string& name() const { return name_; }
  const std::string& world() const { return world_; }
  const Remarks& remarks() const { return remarks_; }
  // Returns the name and line of the last pose, for messages.
  std::string place() const;
  // Throws Error(refused) that there is no pose.
  [[noreturn]] void refuse_empty() const;

  // Returns the largest deviation of a rotation before it was normalised.
  double largest_deviation() const { return parser_.largest_deviation(); }

 private:
  struct Line {
    std::string text;
    std::size_t number = 0;
  };

  // Throws Error(refused) if reading has failed.
  void check_read();
  // Takes the whole stream if it begins as an array of NumPy does.
  void begin_array();
  std::optional<Pose> next_of_array();
  // Returns the next line with more than a comment; empty at the end. `stops_at_blank` returns ""
  // for a blank line.
  std::optional<std::string> next_line(bool stops_at_blank = false);
  // Returns the next line; empty at the end. Throws Error(refused), naming it, if it is no text.
  std::optional<std::string> any_line();
  // Returns the poses of a JSON text, several if it is a list of them, and of the lines after it
  // until its brackets close.
  std::vector<ToldPose> parse_json(std::string text);
  void add_lines_of_json(std::string& text);
  ToldPose parse_text(const std::string& line);
  // Adds the lines of a matrix after its first.
  void add_rows(std::vector<double>& numbers);

  PoseReader(const std::string& path, std::optional<mcap::Poses> poses);

  std::string name_, world_;
  Remarks remarks_;
  std::ifstream file_;
  std::istringstream recorded_;  // of MCAP
  std::istream& stream_;
  int fault_ = 0;          // errno of what failed
  bool may_wait_ = false;  // it is no regular file
  file::LineStream lines_;
  std::string bytes_;                    // of an array
  std::optional<file::NpyArray> array_;  // if the file is one
  std::size_t per_pose_ = 0;             // numbers of a pose in the array
  PoseParser parser_;
  int rows_ = 0;  // lines of each matrix: 3 or 4, 0 before the first
  bool has_passed_blank_ = false;
  std::size_t heading_ = 1;          // number of the line that may name the columns
  std::optional<Line> ahead_;        // has been read already
  std::size_t read_ = 0, line_ = 0;  // lines read, and the line of the last pose
  std::vector<ToldPose> list_;       // poses of the last line
  std::size_t item_ = 0;             // counts those of the list that were returned
  ToldPose last_;
};

// Returns the pose, camera to world, of a file that holds exactly one: in the formats of
// PoseReader, or lists of JSON or as numpy prints them, also over several lines, or a JSON object
// with "matrix", "transform_matrix", "camera_pose" or "pose" (4x4 or 3x4 by rows, flat or nested,
// or 7 numbers), or with "extrinsic" (world to camera; by columns, as Open3D writes it, or nested
// by rows), which is inverted. `deviation` as in rotation_from_quaternion. Throws Error(refused),
// naming the file, for any other.
Pose read_camera_pose(const std::string& path, double* deviation = nullptr);

}  // namespace vpm
