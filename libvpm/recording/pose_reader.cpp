#include "libvpm/recording/pose_reader.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/sniff.h"
#include "libvpm/file/stream.h"
#include "libvpm/recording/pose_json.h"
#include "libvpm/recording/pose_numbers.h"

namespace vpm {
namespace {

constexpr const char* kBlank = " \t\r";

bool is_last_row(const std::vector<double>& row) {
  return row == std::vector<double>{0, 0, 0, 1};
}

// True if the row after three others may be the first of the next matrix of three rows.
bool may_begin_matrix(const std::vector<double>& row) {
  if (row.size() != kMatrixRow) return false;
  return std::abs(row[0] * row[0] + row[1] * row[1] + row[2] * row[2] - 1) <= kRotationTolerance;
}

bool may_be_by_columns(std::vector<double> rows, const std::vector<double>& last) {
  rows.insert(rows.end(), last.begin(), last.end());
  return is_by_columns(rows);
}

// Refuses what is known by its first line to hold no poses.
void refuse_foreign(const std::string& line, const std::string& name) {
  const std::string start = line + "\n";
  const auto other = file::sniff(std::as_bytes(std::span(start.data(), start.size())));
  if (!other) return;
  const bool is_bag = other->what.find(" ROS") != std::string::npos;  // it may hold poses, too
  refuse("this is " + other->what, name,
         is_bag || other->holds == file::Holds::anything
             ? other->next
             : "write poses as lines tx ty tz qx qy qz qw, as JSON or as .npy");
}

// Returns how many numbers each pose of an array has.
std::size_t numbers_per_pose(const std::vector<std::uint64_t>& shape, const std::string& name) {
  const std::size_t dimensions = shape.size();
  const std::uint64_t last = dimensions > 0 ? shape.back() : 0;
  if ((dimensions == 2 || dimensions == 3) && last == kMatrixRow) {
    const std::uint64_t rows = shape[dimensions - 2];
    if (rows == 3 || rows == 4) return rows * kMatrixRow;
  }
  if (dimensions == 1 || dimensions == 2)
    for (const std::size_t count : {kQuaternionPose, kTimedPose, kThreeRows, kMatrix})
      if (last == count) return count;
  refuse("an array of " + file::shape_text(shape) + " holds no poses", name,
         "save matrices, N x 4 x 4 or N x 3 x 4, or N x 7 numbers tx ty tz qx qy qz qw");
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

// Returns the poses that the path names in a recording, if it names some.
std::optional<mcap::Poses> recorded_poses(const std::string& path) {
  const auto name = path == "-" ? std::nullopt : mcap::poses_name(path);
  return name ? std::optional(mcap::read_poses(*name)) : std::nullopt;
}

}  // namespace

PoseReader::PoseReader(const std::string& path) : PoseReader(path, recorded_poses(path)) {}

PoseReader::PoseReader(const std::string& path, std::optional<mcap::Poses> poses)
    : name_(path == "-" ? "standard input" : path),
      stream_(poses         ? static_cast<std::istream&>(recorded_)
              : path == "-" ? std::cin
                            : file_),
      lines_(stream_) {
  if (poses) {
    recorded_.str(std::move(poses->lines));
    world_ = std::move(poses->world);
    remarks_ = std::move(poses->remarks);
    return;
  }
  std::error_code fault;
  may_wait_ = !std::filesystem::is_regular_file(path == "-" ? "/dev/stdin" : path, fault);
  if (path == "-") return;
  errno = 0;
  file_.open(path);
  if (!file_) refuse("cannot read " + path + ": " + std::strerror(errno));
}

void PoseReader::check_read() {
  if (!stream_.bad()) return;
  if (fault_ == 0) fault_ = errno;
  refuse("cannot read " + name_ + ": " + std::strerror(fault_));
}

void PoseReader::refuse_empty() const {
  refuse("no pose in it", name_, "each line gives one: tx ty tz qx qy qz qw, or JSON");
}

std::optional<std::string> PoseReader::any_line() {
  errno = 0;
  line_ = ++read_;
  try {
    std::optional<std::string> line = lines_.next();
    if (line && line_ == 1)
      line->erase(0, line->size() - file::without_byte_order_mark(*line).size());
    if (!line) line_ = --read_;
    if (line && line_ == 1) refuse_foreign(*line, name_);
    return line;
  } catch (const Error& fault) {
    refuse(fault.problem(), fault.where().empty() ? place() : fault.where(), fault.hint());
  }
}

void PoseReader::begin_array() {
  constexpr int kFirstByte = 0x93;  // of .npy
  errno = 0;
  const int first = stream_.peek();
  check_read();
  if (first != kFirstByte) return;
  bytes_ = file::rest_of(stream_);
  array_ = file::parse_npy(std::as_bytes(std::span(bytes_.data(), bytes_.size())), name_);
  per_pose_ = numbers_per_pose(array_->shape, name_);
}

std::optional<Pose> PoseReader::next_of_array() {
  if (!has_more()) return std::nullopt;
  std::vector<double> numbers(per_pose_);
  for (std::size_t k = 0; k < per_pose_; ++k) numbers[k] = array_->at(item_ * per_pose_ + k);
  ++item_;
  parser_.forget_last();
  try {
    last_ = parser_.of_numbers(std::move(numbers));
    return last_.pose;
  } catch (const Error& fault) {
    last_.time = parser_.time();
    refuse(fault.problem(), place(), fault.hint());
  }
}

std::optional<std::string> PoseReader::next_line(bool stops_at_blank) {
  if (ahead_) {
    line_ = ahead_->number;
    return std::exchange(ahead_, std::nullopt)->text;
  }
  while (std::optional<std::string> line = any_line()) {
    if (is_json(*line)) return line;
    const std::size_t comment = std::min(line->find('#'), line->size());
    const bool is_comment = comment < line->size();
    if (is_comment) parser_.take_names(line->substr(comment), line_);
    line->resize(comment);
    if (line_ == heading_ && line->starts_with("sep=")) {  // as Excel writes and wants it
      ++heading_;
      continue;
    }
    if (line_ == heading_ && parser_.take_names(*line, line_)) continue;
    if (line->find_first_not_of(kBlank) != std::string::npos) return line;
    has_passed_blank_ = has_passed_blank_ || !is_comment;
    if (stops_at_blank && !is_comment) return "";
  }
  check_read();
  return std::nullopt;
}

std::optional<Pose> PoseReader::next() {
  if (read_ == 0 && !array_) begin_array();
  if (array_) return next_of_array();
  if (!has_more()) {
    list_.clear();
    item_ = 0;
    const std::optional<std::string> line = next_line();
    if (!line) return std::nullopt;
    parser_.forget_last();
    try {
      list_ = is_json(*line) ? parse_json(*line) : std::vector{parse_text(*line)};
    } catch (const Error& fault) {
      last_.time = parser_.time();
      const std::string what = fault.where().empty() ? "" : fault.where() + ": ";
      refuse(what + fault.problem(), place(), fault.hint());
    }
    item_ = 0;
  }
  last_ = list_[item_++];
  return last_.pose;
}

std::optional<PoseLines> PoseReader::next_lines() {
  if (has_more() || ahead_ || array_ || read_ == 0) return std::nullopt;
  errno = 0;
  std::string text = lines_.next_lines(may_wait_);
  check_read();
  if (text.empty()) return std::nullopt;
  const std::size_t count = file::count_lines(text);
  read_ += count;
  return PoseLines{std::move(text), count, parser_};
}

void PoseReader::give_back(std::string_view lines) {
  read_ -= file::count_lines(lines);
  lines_.give_back(lines);
}

bool PoseReader::has_more() const {
  return array_ ? (item_ + 1) * per_pose_ <= array_->size : item_ < list_.size();
}

std::string PoseReader::place() const {
  const std::string item = item_ > 0 && list_.size() != 1 ? ", pose " + std::to_string(item_) : "";
  if (array_) return name_ + item;
  return name_ + ", line " + std::to_string(line_) + item;
}

void PoseReader::add_lines_of_json(std::string& text) {
  constexpr std::size_t kMost = std::size_t{1} << 24U;  // bytes; 100,000 poses
  const std::size_t first = line_;
  OpenBrackets brackets;
  brackets.add(text);
  while (brackets.are_open()) {
    const std::optional<std::string> line = any_line();
    if (!line) break;
    brackets.add(*line);
    text += '\n' + *line;
    if (text.size() > kMost)
      refuse("a list of poses of more than 16 MiB", {}, "write each pose on a line of its own");
  }
  line_ = first;
  if (brackets.are_open())
    refuse("a bracket that opens here is not closed", {}, "close it, or write a pose on each line");
}

std::vector<ToldPose> PoseReader::parse_json(std::string text) {
  add_lines_of_json(text);
  const nlohmann::json value = json_or_print(text);
  if (value.is_discarded()) {
    refuse("not JSON", {},
           "write each pose as [tx,ty,tz,qx,qy,qz,qw], or in an object as \"pose\"");
  }
  const nlohmann::json* const list = list_of_poses(value);
  if (list == nullptr) return {parser_.of_value(value)};
  if (list->empty()) refuse("\"poses\" is an empty list");
  std::vector<ToldPose> poses;
  for (const nlohmann::json& item : *list) {
    item_ = poses.size() + 1;
    poses.push_back(parser_.of_value(item));
  }
  return poses;
}

ToldPose PoseReader::parse_text(const std::string& line) {
  std::vector<double> numbers = numbers_of_line(line);
  if (numbers.size() == kMatrixRow) add_rows(numbers);
  return parser_.of_numbers(std::move(numbers));
}

void PoseReader::add_rows(std::vector<double>& numbers) {
  const std::string matrix = rows_ == 3 ? "3x4 matrix" : "4x4 matrix";
  const auto add = [&](const std::string& line) {
    const std::vector<double> row = numbers_of_line(line);
    if (row.size() != kMatrixRow) refuse("a row of a " + matrix + " must have four numbers");
    numbers.insert(numbers.end(), row.begin(), row.end());
  };
  if (rows_ == 3 && is_last_row(numbers))
    refuse("the first matrix has three rows, and this one a fourth, 0 0 0 1", {},
           "give all matrices three rows, or all four");
  has_passed_blank_ = false;
  while (numbers.size() < kThreeRows) {
    const std::optional<std::string> row = next_line();
    if (!row) refuse("the file ends inside of a " + matrix);
    add(*row);
  }
  if (rows_ == 3) return;
  // A blank line ends a matrix of three rows, but not where one stands between all rows.
  const bool blank_ends = rows_ == 0 && !has_passed_blank_;
  const std::optional<std::string> row = next_line(blank_ends);
  if (!row && rows_ == 4) refuse("the file ends inside of a 4x4 matrix");
  if (!row || row->empty()) {
    rows_ = 3;
  } else if (rows_ == 0 && may_begin_matrix(numbers_of_line(*row))) {
    if (may_be_by_columns(numbers, numbers_of_line(*row)))
      refuse("a row that may end a 4x4 matrix by columns, or begin the next of three rows", {},
             "write each matrix on a line of its own");
    rows_ = 3;
    ahead_ = Line{*row, line_};
  } else {
    add(*row);
    rows_ = 4;
  }
}

Pose read_camera_pose(const std::string& path, double* deviation) {
  const std::string text = file::utf8_of(file::as_text(file::read_all(path)));
  try {
    const nlohmann::json value = json_or_print(text);
    if (value.is_object())
      if (const auto pose = camera_of_object(value, deviation)) return *pose;
    if (value.is_array() && list_of_poses(value) == nullptr) {
      const std::vector<double> n = numbers_of(value);
      if (n.size() != kTimedPose) return from_untimed(n, deviation);
    }
  } catch (const Error& fault) {
    refuse(fault.problem(), path, fault.hint());
  }
  return only_pose(path, deviation);
}

}  // namespace vpm
