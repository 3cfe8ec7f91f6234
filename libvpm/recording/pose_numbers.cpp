#include "libvpm/recording/pose_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

constexpr const char* kBetween = " \t\r,;";

constexpr const char* kDecimalPoint = "write decimals with a point, or separate all numbers alike";

void refuse_empty_cells(const std::string& line, char separator) {
  if (line.find(separator) == std::string::npos) return;
  std::size_t cell = 1;
  for (std::size_t begin = 0; begin <= line.size(); ++cell) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    if (line.find_first_not_of(" \t\r", begin) >= end)
      refuse("number " + std::to_string(cell) + " is missing: nothing stands between the " +
             (separator == ',' ? "commas" : "semicolons"));
    begin = end + 1;
  }
}

// True for a line of COLMAP's images.txt: image, quaternion with w first, translation, camera and
// name.
bool is_image_of_colmap(const std::vector<std::string_view>& words) {
  constexpr std::size_t kWords = 10, kCamera = 8;
  if (words.size() < kWords || file::to_number(words[kWords - 1])) return false;
  if (!file::to_count(words[0]) || !file::to_count(words[kCamera])) return false;
  double squares = 0;
  for (std::size_t k = 1; k < kCamera; ++k) {
    const std::optional<double> value = file::to_number(words[k]);
    if (!value) return false;
    if (k <= 4) squares += *value * *value;
  }
  return std::abs(squares - 1) <= kRotationTolerance;
}

// Refuses the word of a line that is no number, with what would mend the file.
[[noreturn]] void refuse_word(const std::vector<std::string_view>& words, std::size_t at) {
  if (is_image_of_colmap(words)) {
    refuse("it looks like images.txt of COLMAP, whose poses map the world to the camera, w first",
           {}, "convert each to a line tx ty tz qx qy qz qw of the inverse pose");
  }
  const std::string_view word = words[at];
  const std::string column = "column " + std::to_string(at + 1);
  if (at == 0 && (word.front() == '%' || word.starts_with("//")))
    refuse("not a number: " + file::shown(word), {}, "let comments begin with #");
  if (word.size() > 2 && (word.front() == '"' || word.front() == '\'') &&
      file::to_number(word.substr(1, word.size() - 2))) {
    refuse(column + " stands in quotes: " + file::shown(word), {}, "write numbers without quotes");
  }
  const auto numbers = static_cast<std::size_t>(
      std::count_if(words.begin(), words.end(),
                    [](std::string_view other) { return file::to_number(other).has_value(); }));
  const bool is_one_of_others = numbers + 1 == words.size() && numbers >= kQuaternionPose;
  refuse(column + " is not a number: " + file::shown(word), {},
         is_one_of_others ? "leave this column out" : "");
}

std::string numbers_in_words(const double* numbers, std::size_t count) {
  std::string words;
  for (std::size_t k = 0; k < count; ++k) {
    char text[32];
    std::snprintf(text, sizeof text, "%s%.6g", k == 0 ? "" : " ", numbers[k]);
    words += text;
  }
  return words;
}

}  // namespace

std::vector<double> numbers_of_line(const std::string& line) {
  const bool has_semicolon = line.find(';') != std::string::npos;
  if (has_semicolon && line.find(',') != std::string::npos)
    refuse("semicolons and commas stand between its numbers", {}, kDecimalPoint);
  refuse_empty_cells(line, has_semicolon ? ';' : ',');
  const std::vector<std::string_view> words = file::split_words(line, kBetween);
  std::vector<double> numbers;
  bool has_bare_comma = false, has_bare_blank = false;
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::optional<double> value = file::to_number(words[k]);
    if (!value) refuse_word(words, k);
    numbers.push_back(*value);
    if (k == 0) continue;
    const char* const end = words[k - 1].data() + words[k - 1].size();
    const std::string_view between(end, static_cast<std::size_t>(words[k].data() - end));
    has_bare_comma = has_bare_comma || between == ",";
    has_bare_blank = has_bare_blank || between.find_first_of(",;") == between.npos;
  }
  // "0,1 0 1 0 0 0 1" would be another pose, with a time.
  if (has_bare_comma && has_bare_blank && numbers.size() > kQuaternionPose)
    refuse("commas stand between some of its numbers and blanks between others", {}, kDecimalPoint);
  return numbers;
}

bool is_by_columns(const std::vector<double>& m) {
  if (m.size() != kMatrix) return false;
  const bool has_translation = m[12] != 0 || m[13] != 0 || m[14] != 0;
  return has_translation && m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1;
}

Pose from_matrix(std::vector<double> m, const std::string& otherwise, double* deviation) {
  if (m.size() == kThreeRows) m.insert(m.end(), {0, 0, 0, 1});
  if (m.size() != kMatrix) refuse(otherwise);
  const std::string last = numbers_in_words(&m[12], kMatrixRow);
  if (is_by_columns(m)) {
    refuse("the 4x4 matrix is written by columns: its last column is 0 0 0 1, and its last row " +
               last + " ends in 1",
           {}, "transpose it");
  }
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1) refuse(otherwise + ", not " + last);
  return {rotation_from_matrix({m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}, deviation),
          {m[3], m[7], m[11]}};
}

Pose from_untimed(const std::vector<double>& n, double* deviation) {
  Pose pose;
  if (n.size() == kQuaternionPose) {
    pose = {rotation_from_quaternion({n[3], n[4], n[5], n[6]}, deviation), {n[0], n[1], n[2]}};
  } else if (n.size() == kThreeRows || n.size() == kMatrix) {
    pose = from_matrix(n, "the last row of a 4x4 pose must be 0 0 0 1", deviation);
  } else if (n.size() == kAnglesPose) {
    refuse("found 6 numbers, like a position with three angles", {}, kAnglesHint);
  } else {
    refuse("found " + std::to_string(n.size()) + " numbers", {},
           "a pose has 7 (tx ty tz qx qy qz qw), 8 (with a time before them) or 16 (4x4, row by "
           "row), or 12 without the last row");
  }
  if (!is_in_range(pose.translation))
    refuse("the translation is not finite, or further than 2^100 m from the origin", "pose");
  return pose;
}

}  // namespace vpm
