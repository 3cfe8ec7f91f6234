#include "libvpm/recording/pose_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

// Returns the names in lower case; between commas if there are any.
std::vector<std::string> names_of(std::string line) {
  line.erase(0, line.find_first_not_of("# \t"));
  const bool has_commas = line.find(',') != line.npos;
  std::replace(line.begin(), line.end(), ',', '\n');
  std::vector<std::string> names;
  file::TextCursor cursor(line);
  if (!has_commas) {
    for (const std::string_view word : file::split_words(line))
      names.push_back(file::in_lower_case(word));
    return names;
  }
  while (const auto cell = cursor.line()) names.push_back(file::in_lower_case(*cell));
  return names;
}

// Returns the name without its unit and blanks: "q_rs_w" of " q_rs_w []".
std::string bare(const std::string& name) {
  std::string text = name.substr(0, name.find_first_of("[("));
  text.erase(0, std::min(text.find_first_not_of(" \t\""), text.size()));
  text.erase(std::min(text.find_last_not_of(" \t\"") + 1, text.size()));
  return text;
}

// True if the name ends in the axis, and what is before it is `letter`, or begins with it and ends
// in a separator.
bool is_axis_of(const std::string& name, char axis, const char* letters) {
  if (name.empty() || name.back() != axis) return false;
  const std::string before = name.substr(0, name.size() - 1);
  if (before.empty()) return false;
  const bool begins = std::string(letters).find(before.front()) != std::string::npos;
  return begins && (before.size() == 1 || before.back() == '_' || before.back() == '.');
}

bool is_time(const std::string& name) {
  return name.starts_with("time") || name.starts_with("stamp") || name == "t" || name == "sec";
}

// Returns the columns that a line names, such as "# timestamp tx ty tz qw qx qy qz" or the header
// of EuRoC's ground truth; empty if it does not name all seven numbers of a pose.
std::optional<PoseColumns> columns_of_header(const std::string& line) {
  const std::vector<std::string> names = names_of(line);
  PoseColumns columns;
  columns.count = names.size();
  int positions = 0, quaternions = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = bare(names[i]);
    for (std::size_t axis = 0; axis < 4; ++axis) {
      const char letter = "xyzw"[axis];
      if (is_axis_of(name, letter, "qor")) {  // q, orientation, rotation
        columns.quaternion[axis] = i;
        ++quaternions;
      } else if (axis < 3 && (name == std::string(1, letter) || is_axis_of(name, letter, "tp"))) {
        columns.position[axis] = i;
        ++positions;
      }
    }
    if (!columns.time && is_time(name)) {
      columns.time = i;
      columns.has_nanoseconds = names[i].find("[ns]") != std::string::npos;
    }
  }
  return positions == 3 && quaternions == 4 ? std::optional(columns) : std::nullopt;
}

// Returns time (if there is one), position and quaternion x, y, z, w of a line with these columns.
// A line with one number more has its time in front. Throws Error(refused) for other counts.
std::vector<double> in_usual_order(const std::vector<double>& numbers, const PoseColumns& columns) {
  const bool has_time_before = !columns.time && numbers.size() == columns.count + 1;
  if (numbers.size() != columns.count && !has_time_before)
    refuse("found " + std::to_string(numbers.size()) + " numbers where the line of names has " +
           std::to_string(columns.count));
  std::vector<double> pose;
  if (has_time_before) pose.push_back(numbers.front());
  if (columns.time) {
    const double time = numbers[*columns.time];
    pose.push_back(columns.has_nanoseconds ? 1e-9 * time : time);
  }
  for (const std::size_t column : columns.position)
    pose.push_back(numbers[column + has_time_before]);
  for (const std::size_t column : columns.quaternion)
    pose.push_back(numbers[column + has_time_before]);
  return pose;
}

constexpr std::size_t kQuaternionPose = 7, kTimedPose = 8, kMatrix = 16, kMatrixRow = 4;

constexpr const char* kBlank = " \t\r";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // written first by some editors

bool is_json(const std::string& line) {
  const std::size_t first = line.find_first_not_of(kBlank);
  return first != std::string::npos && (line[first] == '{' || line[first] == '[');
}

void refuse_empty_cells(const std::string& line) {
  if (line.find(',') == std::string::npos) return;
  std::size_t cell = 1;
  for (std::size_t begin = 0; begin <= line.size(); ++cell) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    if (line.find_first_not_of(kBlank, begin) >= end)
      refuse("number " + std::to_string(cell) + " is missing: nothing stands between the commas");
    begin = end + 1;
  }
}

// Returns the numbers of a line, separated by blanks or single commas.
std::vector<double> numbers_of(const std::string& line) {
  constexpr const char* kBetween = " \t\r,";
  refuse_empty_cells(line);
  std::vector<double> numbers;
  for (std::size_t at = line.find_first_not_of(kBetween); at != std::string::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    const std::string word = line.substr(at, end - at);
    const std::optional<double> value = file::to_number(word);
    if (!value) refuse("not a number: " + file::shown(word));
    numbers.push_back(*value);
    at = line.find_first_not_of(kBetween, end);
  }
  return numbers;
}

// Returns the numbers of a list, or of a list of lists, row by row. Throws a refusal at anything
// else.
std::vector<double> numbers_of(const nlohmann::json& value) {
  if (!value.is_array()) refuse("a pose must be a list of numbers");
  std::vector<double> numbers;
  for (const nlohmann::json& item : value) {
    for (const nlohmann::json& number : item.is_array() ? item : nlohmann::json::array({item})) {
      if (!number.is_number()) refuse("a pose must be a list of numbers");
      numbers.push_back(number.get<double>());
    }
  }
  return numbers;
}

using nlohmann::json;

Pose from_matrix(const std::vector<double>& m, double* deviation) {
  if (m.size() != 16 || m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    refuse("a camera's matrix has 4x4 numbers by rows, the last row 0 0 0 1");
  return {rotation_from_matrix({m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}, deviation),
          {m[3], m[7], m[11]}};
}

std::vector<double> transposed(const std::vector<double>& m) {
  if (m.size() != 16) return m;
  std::vector<double> turned(16);
  for (std::size_t i = 0; i < 16; ++i) turned[i] = m[4 * (i % 4) + i / 4];
  return turned;
}

// Returns the pose of a JSON object; empty if it has none of the keys.
std::optional<Pose> from_object(const json& object, double* deviation) {
  if (object.contains("extrinsic"))
    return inverse(from_matrix(transposed(numbers_of(object["extrinsic"])), deviation));
  for (const char* key : {"matrix", "transform_matrix", "camera_pose", "pose"}) {
    if (!object.contains(key)) continue;
    const std::vector<double> n = numbers_of(object[key]);
    if (n.size() != 7) return from_matrix(n, deviation);
    return Pose{rotation_from_quaternion({n[3], n[4], n[5], n[6]}, deviation), {n[0], n[1], n[2]}};
  }
  return std::nullopt;
}

Pose only_pose(const std::string& path, double* deviation) {
  PoseReader reader(path);
  const std::optional<Pose> pose = reader.next();
  if (!pose) reader.refuse_empty();
  if (reader.next())
    refuse("it holds several poses", path,
           "give a file with the one of this image, or its numbers");
  if (deviation != nullptr) *deviation = reader.largest_deviation();
  return *pose;
}

}  // namespace

PoseReader::PoseReader(const std::string& path)
    : name_(path == "-" ? "standard input" : path),
      stream_(path == "-" ? std::cin : file_),
      lines_(stream_) {
  if (path == "-") return;
  errno = 0;
  file_.open(path);
  if (!file_) refuse("cannot read " + path + ": " + std::strerror(errno));
}

void PoseReader::refuse_empty() const {
  refuse("no pose in it", name_, "each line gives one: tx ty tz qx qy qz qw, or JSON");
}

std::optional<std::string> PoseReader::any_line() {
  errno = 0;
  ++line_;
  try {
    std::optional<std::string> line = lines_.next();
    if (line && line_ == 1 && line->starts_with(kByteOrderMark))
      line->erase(0, kByteOrderMark.size());
    if (!line) --line_;
    return line;
  } catch (const Error& fault) {
    refuse(fault.problem(), place(), fault.hint());
  }
}

std::optional<std::string> PoseReader::next_line() {
  while (std::optional<std::string> line = any_line()) {
    if (is_json(*line)) return line;
    if (line_ == 1 || line->starts_with('#')) {
      if (const auto columns = columns_of_header(*line)) {
        columns_ = columns;
        continue;
      }
    }
    line->resize(std::min(line->find('#'), line->size()));
    if (line->find_first_not_of(kBlank) != std::string::npos) return line;
  }
  if (stream_.bad()) refuse("cannot read " + name_ + ": " + std::strerror(errno));
  return std::nullopt;
}

std::optional<Pose> PoseReader::next() {
  const std::optional<std::string> line = next_line();
  if (!line) return std::nullopt;
  time_.reset();
  try {
    return is_json(*line) ? parse_json(*line) : parse_text(*line);
  } catch (const Error& fault) {
    const std::string what = fault.where().empty() ? "" : fault.where() + ": ";
    refuse(what + fault.problem(), place(), fault.hint());
  }
}

Pose PoseReader::parse_json(const std::string& line) {
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  if (json.is_discarded()) refuse("not JSON", {}, "a line must be one whole pose");
  if (json.is_array()) return from_numbers(numbers_of(json));
  if (json.contains("time")) {
    if (!json["time"].is_number()) refuse("\"time\" must be a number of seconds");
    time_ = seconds_of_stamp(json["time"].get<double>());
  }
  for (const char* key : {"pose", "matrix"}) {
    if (json.contains(key)) return from_numbers(numbers_of(json[key]));
  }
  refuse("neither \"pose\" nor \"matrix\" in the object");
}

Pose PoseReader::parse_text(const std::string& line) {
  std::vector<double> numbers = numbers_of(line);
  if (numbers.size() == kMatrixRow) {
    while (numbers.size() < kMatrix) {
      const std::optional<std::string> row = next_line();
      if (!row) refuse("the file ends inside of a 4x4 matrix");
      const std::vector<double> more = numbers_of(*row);
      if (more.size() != kMatrixRow) refuse("a row of a 4x4 matrix must have four numbers");
      numbers.insert(numbers.end(), more.begin(), more.end());
    }
  } else if (columns_) {
    numbers = in_usual_order(numbers, *columns_);
  }
  return from_numbers(std::move(numbers));
}

Pose PoseReader::from_numbers(std::vector<double> n) {
  if (n.size() == kTimedPose && !time_) {
    time_ = seconds_of_stamp(n.front());
    n.erase(n.begin());
  }
  Pose pose;
  double deviation = 0;
  if (n.size() == kQuaternionPose) {
    pose = {rotation_from_quaternion({n[3], n[4], n[5], n[6]}, &deviation), {n[0], n[1], n[2]}};
  } else if (n.size() == kMatrix) {
    if (n[12] != 0 || n[13] != 0 || n[14] != 0 || n[15] != 1)
      refuse("the last row of a 4x4 pose must be 0 0 0 1");
    pose = {
        rotation_from_matrix({n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]}, &deviation),
        {n[3], n[7], n[11]}};
  } else {
    refuse(
        "found " + std::to_string(n.size()) + " numbers", {},
        "a pose has 7 (tx ty tz qx qy qz qw), 8 (with a time before them) or 16 (4x4, row by row)");
  }
  if (!is_in_range(pose.translation))
    refuse("the translation is not finite, or further than 2^100 m from the origin", "pose");
  largest_deviation_ = std::max(largest_deviation_, deviation);
  return pose;
}

Pose read_camera_pose(const std::string& path, double* deviation) {
  const std::vector<std::byte> bytes = file::read_all(path);
  const json object = json::parse(
      file::as_text(bytes), [](int depth, json::parse_event_t, const json&) { return depth < 16; },
      false);
  if (object.is_object()) {
    try {
      if (const auto pose = from_object(object, deviation)) return *pose;
    } catch (const Error& fault) {
      refuse(fault.problem(), path, fault.hint());
    }
  }
  return only_pose(path, deviation);
}

}  // namespace vpm
