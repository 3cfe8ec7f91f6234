#include "libvpm/recording/pose_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/json_numbers.h"
#include "libvpm/recording/time_stamp.h"

namespace vpm {
namespace {

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

}  // namespace vpm
