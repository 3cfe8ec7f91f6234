#include "libvpm/recording/pose_reader.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/file/json_text.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

using nlohmann::json;

constexpr std::size_t kQuaternionPose = 7, kTimedPose = 8, kThreeRows = 12, kMatrix = 16,
                      kMatrixRow = 4;

constexpr const char* kBlank = " \t\r";

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
  bool has_bare_comma = false, has_bare_blank = false;
  for (std::size_t at = line.find_first_not_of(kBetween); at != std::string::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    const std::string word = line.substr(at, end - at);
    const std::optional<double> value = file::to_number(word);
    if (!value) refuse("not a number: " + file::shown(word));
    numbers.push_back(*value);
    at = line.find_first_not_of(kBetween, end);
    if (at == std::string::npos) break;
    const std::string_view between(line.data() + end, at - end);
    has_bare_comma = has_bare_comma || between == ",";
    has_bare_blank = has_bare_blank || between.find(',') == between.npos;
  }
  // "0,1 0 1 0 0 0 1" would be another pose, with a time.
  if (has_bare_comma && has_bare_blank && numbers.size() > kQuaternionPose)
    refuse("commas stand between some of its numbers and blanks between others", {},
           "write decimals with a point, or separate all numbers alike");
  return numbers;
}

// Returns the numbers of a list, or of a list of lists, row by row. Throws a refusal at anything
// else, and at a matrix whose rows are not of four numbers.
std::vector<double> numbers_of(const json& value) {
  if (!value.is_array()) refuse("a pose must be a list of numbers");
  std::vector<double> numbers;
  bool has_other_rows = false;
  for (const json& item : value) {
    has_other_rows = has_other_rows || (item.is_array() && item.size() != kMatrixRow);
    for (const json& number : item.is_array() ? item : json::array({item})) {
      if (!number.is_number()) refuse("a pose must be a list of numbers");
      numbers.push_back(number.get<double>());
    }
  }
  if (has_other_rows && (numbers.size() == kThreeRows || numbers.size() == kMatrix))
    refuse("a row of a matrix must have four numbers");
  return numbers;
}

// Returns lists as numpy prints them, "[[1. 0.]\n [0. 1.]]", as JSON; a discarded value for any
// other text.
json json_of_print(std::string_view text) {
  std::string lists;
  const auto begin_item = [&] {
    if (!lists.empty() && lists.back() != '[') lists += ',';
  };
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '[') {
      begin_item();
      lists += '[';
    } else if (text[at] == ']') {
      lists += ']';
    } else if (std::string_view(" \t\r\n,").find(text[at]) == std::string_view::npos) {
      const std::size_t end = std::min(text.find_first_of("[] \t\r\n,", at), text.size());
      const std::optional<double> number = file::to_number(text.substr(at, end - at));
      if (!number) return json(json::value_t::discarded);
      begin_item();
      lists += json(*number).dump();
      at = end - 1;
    }
  }
  return json::parse(lists, nullptr, false);
}

// Returns the time of an object in seconds; empty if it has none.
std::optional<double> time_of(const json& object) {
  std::string found;
  for (const char* key : {"time", "timestamp", "stamp", "t"}) {
    if (!object.contains(key)) continue;
    if (std::string_view(key) == "t" && object[key].is_array()) continue;  // a translation
    if (!found.empty())
      refuse("both \"" + found + "\" and \"" + key + "\" in the object", {}, "give one time");
    found = key;
  }
  if (found.empty()) return std::nullopt;
  if (!object[found].is_number()) refuse("\"" + found + "\" must be a number of seconds");
  return seconds_of_stamp(object[found].get<double>());
}

// Returns the pose of a matrix by rows, 4x4 or without the last of them.
Pose from_matrix(std::vector<double> m, const char* otherwise, double* deviation) {
  if (m.size() == kThreeRows) m.insert(m.end(), {0, 0, 0, 1});
  if (m.size() != kMatrix || m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    refuse(otherwise);
  return {rotation_from_matrix({m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}, deviation),
          {m[3], m[7], m[11]}};
}

// True if a number is not finite, or all are zero.
bool are_undefined(const std::vector<double>& numbers) {
  const auto is_infinite = [](double number) { return !std::isfinite(number); };
  return std::any_of(numbers.begin(), numbers.end(), is_infinite) ||
         std::all_of(numbers.begin(), numbers.end(), [](double number) { return number == 0; });
}

// Returns the pose of 7 numbers, or of a matrix by rows.
Pose from_untimed(const std::vector<double>& n, double* deviation) {
  Pose pose;
  if (n.size() == kQuaternionPose) {
    pose = {rotation_from_quaternion({n[3], n[4], n[5], n[6]}, deviation), {n[0], n[1], n[2]}};
  } else if (n.size() == kThreeRows || n.size() == kMatrix) {
    pose = from_matrix(n, "the last row of a 4x4 pose must be 0 0 0 1", deviation);
  } else {
    refuse("found " + std::to_string(n.size()) + " numbers", {},
           "a pose has 7 (tx ty tz qx qy qz qw), 8 (with a time before them) or 16 (4x4, row by "
           "row), or 12 without the last row");
  }
  if (!is_in_range(pose.translation))
    refuse("the translation is not finite, or further than 2^100 m from the origin", "pose");
  return pose;
}

constexpr const char* kNoCameraMatrix =
    "a camera's matrix has 4x4 numbers by rows, the last row 0 0 0 1";

// Returns the pose of a camera from the inverse of its matrix, which Open3D writes as one list of
// columns, others as lists of rows.
Pose from_extrinsic(const json& extrinsic, double* deviation) {
  std::vector<double> m = numbers_of(extrinsic);
  if (!m.empty() && extrinsic.front().is_array())
    return inverse(from_matrix(m, kNoCameraMatrix, deviation));
  if (m.size() != kMatrix)
    refuse(
        "\"extrinsic\" has neither 16 numbers by columns, as Open3D writes it, nor lists of rows");
  std::vector<double> rows(kMatrix);
  for (std::size_t i = 0; i < kMatrix; ++i) rows[i] = m[4 * (i % 4) + i / 4];
  return inverse(from_matrix(
      rows, "\"extrinsic\" has 4x4 numbers by columns, the last of each 0, 0, 0 and 1", deviation));
}

// Returns the pose of a JSON object; empty if it has none of the keys.
std::optional<Pose> from_object(const json& object, double* deviation) {
  if (object.contains("extrinsic")) return from_extrinsic(object["extrinsic"], deviation);
  for (const char* key : {"matrix", "transform_matrix", "camera_pose", "pose"}) {
    if (!object.contains(key)) continue;
    const std::vector<double> n = numbers_of(object[key]);
    return n.size() == kQuaternionPose ? from_untimed(n, deviation)
                                       : from_matrix(n, kNoCameraMatrix, deviation);
  }
  return std::nullopt;
}

// Returns the pose of a matrix or list that may go over several lines; empty for other counts.
std::optional<Pose> from_list(const json& list, double* deviation) {
  const std::vector<double> n = numbers_of(list);
  if (n.size() != kQuaternionPose && n.size() != kThreeRows && n.size() != kMatrix)
    return std::nullopt;
  return from_untimed(n, deviation);
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
    if (line && line_ == 1)
      line->erase(0, line->size() - file::without_byte_order_mark(*line).size());
    if (!line) --line_;
    return line;
  } catch (const Error& fault) {
    refuse(fault.problem(), place(), fault.hint());
  }
}

bool PoseReader::take_names(const std::string& text) {
  std::optional<PoseNames> found = names_in(text, line_);
  if (!found) return false;
  if (!found->orders.empty() || !names_) names_ = std::move(found);
  return true;
}

std::optional<std::string> PoseReader::next_line() {
  while (std::optional<std::string> line = any_line()) {
    if (is_json(*line)) return line;
    const std::size_t comment = std::min(line->find('#'), line->size());
    if (comment < line->size()) take_names(line->substr(comment));
    line->resize(comment);
    if (line_ == 1 && take_names(*line)) continue;
    if (line->find_first_not_of(kBlank) != std::string::npos) return line;
  }
  if (stream_.bad()) refuse("cannot read " + name_ + ": " + std::strerror(errno));
  return std::nullopt;
}

std::optional<Pose> PoseReader::next() {
  const std::optional<std::string> line = next_line();
  if (!line) return std::nullopt;
  time_.reset();
  is_undefined_ = false;
  try {
    return is_json(*line) ? parse_json(*line) : parse_text(*line);
  } catch (const Error& fault) {
    const std::string what = fault.where().empty() ? "" : fault.where() + ": ";
    refuse(what + fault.problem(), place(), fault.hint());
  }
}

Pose PoseReader::parse_json(const std::string& line) {
  json value = json::parse(line, file::refusing_doubt(), false);
  if (value.is_discarded()) value = json_of_print(line);
  if (value.is_discarded()) refuse("not JSON", {}, "a line must be one whole pose");
  if (value.is_array()) return from_numbers(numbers_of(value));
  time_ = time_of(value);
  for (const char* key : {"pose", "matrix"}) {
    if (value.contains(key)) return from_numbers(numbers_of(value[key]));
  }
  refuse("neither \"pose\" nor \"matrix\" in the object");
}

Pose PoseReader::parse_text(const std::string& line) {
  std::vector<double> numbers = numbers_of(line);
  if (numbers.size() == kMatrixRow) add_rows(numbers);
  return from_numbers(std::move(numbers));
}

void PoseReader::add_rows(std::vector<double>& numbers) {
  while (numbers.size() < kMatrix) {
    const std::optional<std::string> row = next_line();
    if (!row && numbers.size() == kThreeRows && is_first_) return;  // a file of one 3x4 matrix
    if (!row) refuse("the file ends inside of a 4x4 matrix");
    const std::vector<double> more = numbers_of(*row);
    if (more.size() != kMatrixRow) refuse("a row of a 4x4 matrix must have four numbers");
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
}

Pose PoseReader::from_numbers(std::vector<double> n) {
  is_first_ = false;
  const bool is_matrix = n.size() == kMatrix || n.size() == kThreeRows;
  if (names_ && !(is_matrix && !fitting_order(names_->orders, n.size())))
    n = in_usual_order(n, *names_);
  if (n.size() == kTimedPose && !time_) {
    time_ = seconds_of_stamp(n.front());
    n.erase(n.begin());
  }
  is_undefined_ = are_undefined(n);
  double deviation = 0;
  const Pose pose = from_untimed(n, &deviation);
  largest_deviation_ = std::max(largest_deviation_, deviation);
  return pose;
}

Pose read_camera_pose(const std::string& path, double* deviation) {
  const std::vector<std::byte> bytes = file::read_all(path);
  const std::string_view text = file::as_text(bytes);
  const std::string_view blank = " \t\r\n";
  const std::size_t first = std::min(text.find_first_not_of(blank), text.size());
  try {
    json value = json::parse(text, file::refusing_doubt(), false);
    if (value.is_discarded() && text.substr(first).starts_with('[')) value = json_of_print(text);
    if (value.is_object())
      if (const auto pose = from_object(value, deviation)) return *pose;
    if (value.is_array())
      if (const auto pose = from_list(value, deviation)) return *pose;
  } catch (const Error& fault) {
    refuse(fault.problem(), path, fault.hint());
  }
  return only_pose(path, deviation);
}

}  // namespace vpm
