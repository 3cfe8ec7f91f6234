#include "libvpm/recording/pose_columns.h"

#include <algorithm>

#include "libvpm/core/error.h"
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

}  // namespace

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

}  // namespace vpm
