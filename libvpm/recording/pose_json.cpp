#include "libvpm/recording/pose_json.h"

#include <algorithm>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/file/json_text.h"
#include "libvpm/file/nearest_word.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/pose_columns.h"
#include "libvpm/recording/pose_numbers.h"

namespace vpm {
namespace {

using nlohmann::json;

// Returns what numpy prints as JSON; a discarded value for any other text.
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
  return json::parse(lists, file::refusing_doubt(), false);
}

// Returns how many numbers a list, or a list of lists, holds; none if it holds anything else.
std::size_t count_of(const json& value) {
  std::size_t count = 0;
  for (const json& item : value) {
    if (!item.is_number() && !item.is_array()) return 0;
    if (item.is_array() && !std::all_of(item.begin(), item.end(),
                                        [](const json& number) { return number.is_number(); }))
      return 0;
    count += item.is_array() ? item.size() : 1;
  }
  return count;
}

// True if the list has a pose of its own: not if it is the row of a matrix.
bool is_whole_pose(const json& list) {
  const std::size_t count = list.is_array() ? count_of(list) : 0;
  return count == kQuaternionPose || count == kTimedPose || count == kThreeRows || count == kMatrix;
}

std::optional<double> seconds_of(const json& stamp, const std::string& key) {
  if (stamp.is_number()) return seconds_of_stamp(stamp.get<double>());
  for (const auto& [seconds, rest] : {std::pair{"sec", "nanosec"}, std::pair{"secs", "nsecs"}}) {
    if (!stamp.is_object() || !stamp.contains(seconds) || !stamp.contains(rest)) continue;
    if (stamp[seconds].is_number() && stamp[rest].is_number())
      return stamp[seconds].get<double>() + 1e-9 * stamp[rest].get<double>();
  }
  refuse("\"" + key + "\" must be a number of seconds");
}

// Adds the numbers of an object with these keys, one letter each.
void add_letters(const json& object, const char* key, std::string_view letters,
                 std::vector<double>& numbers) {
  const std::string wanted =
      letters.size() == 3 ? R"({"x": …, "y": …, "z": …})" : R"({"x": …, "y": …, "z": …, "w": …})";
  for (const char letter : letters) {
    const json& value = object[key];
    const std::string name(1, letter);
    if (!value.is_object() || !value.contains(name) || !value[name].is_number())
      refuse(std::string("\"") + key + "\" must be " + wanted);
    numbers.push_back(value[name].get<double>());
  }
}

// Returns position and orientation, each number by its key; empty if the object has none.
std::optional<ObjectPose> pose_of_ros(const json& object) {
  for (const auto& [position, orientation] :
       {std::pair{"position", "orientation"}, std::pair{"translation", "rotation"}}) {
    if (!object.contains(position) || !object.contains(orientation)) continue;
    ObjectPose pose;
    add_letters(object, position, "xyz", pose.numbers);
    add_letters(object, orientation, "xyzw", pose.numbers);
    pose.are_named = true;
    return pose;
  }
  return std::nullopt;
}

std::string keys_of(const json& object) {
  std::vector<std::string> names;
  for (const auto& [key, value] : object.items()) names.push_back('"' + file::shown(key) + '"');
  return names.empty() ? "nothing" : file::listed(names);
}

constexpr const char* kNoCameraMatrix =
    "a camera's matrix has 4x4 numbers by rows, the last row 0 0 0 1";

// Returns the pose of a camera from the inverse of its matrix, which Open3D writes as one list of
// columns, others as lists of rows.
Pose from_extrinsic(const json& extrinsic, double* deviation) {
  const std::vector<double> m = numbers_of(extrinsic);
  if (!m.empty() && extrinsic.front().is_array())
    return inverse(from_matrix(m, kNoCameraMatrix, deviation));
  if (m.size() != kMatrix)
    refuse(
        "\"extrinsic\" has neither 16 numbers by columns, as Open3D writes it, nor lists of rows");
  std::vector<double> rows(kMatrix);
  for (std::size_t i = 0; i < kMatrix; ++i) rows[i] = m[4 * (i % 4) + i / 4];
  if (is_by_columns(rows)) {
    refuse("\"extrinsic\" is one list by rows, which is read by columns, as Open3D writes it", {},
           "give it as lists of rows");
  }
  return inverse(from_matrix(
      rows, "\"extrinsic\" has 4x4 numbers by columns, the last of each 0, 0, 0 and 1", deviation));
}

}  // namespace

bool is_json(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first != line.npos && (line[first] == '{' || line[first] == '[');
}

void OpenBrackets::add(std::string_view line) {
  for (const char letter : line) {
    if (!is_in_text_) {
      add_outside_of_text(letter);
    } else if (is_escaped_) {
      is_escaped_ = false;
    } else {
      is_escaped_ = letter == '\\';
      is_in_text_ = letter != '"';
    }
  }
  is_broken_ = is_broken_ || is_in_text_;  // a text ends in its line
}

void OpenBrackets::add_outside_of_text(char letter) {
  constexpr std::string_view kBlank = " \t\r", kBeforeItem = "[{,:";
  if (kBlank.find(letter) != kBlank.npos) return;
  if (letter == '"') is_in_text_ = true;
  if (letter == '[' || letter == '{') {
    // numpy puts no comma between lists. Another item without one is that of the next line.
    const bool begins_item = depth_ == 0 || kBeforeItem.find(last_) != kBeforeItem.npos ||
                             (letter == '[' && last_ == ']');
    is_broken_ = is_broken_ || !begins_item;
    ++depth_;
  }
  if ((letter == ']' || letter == '}') && depth_ > 0) --depth_;
  last_ = letter;
}

json json_or_print(std::string_view text) {
  json value = json::parse(text, file::refusing_doubt(), false);
  const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  if (value.is_discarded() && text.substr(first).starts_with('[')) return json_of_print(text);
  return value;
}

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

const json* list_of_poses(const json& value) {
  if (value.is_object())
    return value.contains("poses") && value["poses"].is_array() ? &value["poses"] : nullptr;
  if (!value.is_array() || value.empty()) return nullptr;
  const bool is_list =
      std::all_of(value.begin(), value.end(), [](const json& item) { return item.is_object(); }) ||
      std::all_of(value.begin(), value.end(), is_whole_pose);
  return is_list ? &value : nullptr;
}

std::optional<double> time_of(const json& object) {
  std::string found;
  for (const char* key : {"time", "timestamp", "stamp", "t"}) {
    if (!object.contains(key)) continue;
    if (std::string_view(key) == "t" && object[key].is_array()) continue;  // a translation
    if (!found.empty())
      refuse("both \"" + found + "\" and \"" + key + "\" in the object", {}, "give one time");
    found = key;
  }
  if (!found.empty()) return seconds_of(object[found], found);
  const bool has_stamp = object.contains("header") && object["header"].is_object() &&
                         object["header"].contains("stamp");
  return has_stamp ? seconds_of(object["header"]["stamp"], "stamp") : std::nullopt;
}

namespace {

ObjectPose pose_in(const json& object, const char* key) {
  const json& value = object[key];
  return value.is_object() ? pose_of_object(value) : ObjectPose{numbers_of(value), false};
}

}  // namespace

ObjectPose pose_of_object(const json& object) {
  for (const char* key : {"pose", "matrix", "transform_matrix", "transform"}) {
    if (object.contains(key)) return pose_in(object, key);
  }
  if (const auto pose = pose_of_ros(object)) return *pose;
  if (object.contains("tool") && object["tool"].is_structured()) return pose_in(object, "tool");
  refuse("no pose in the object; it has " + keys_of(object), {},
         "give \"pose\" (7 numbers) or \"matrix\" (4x4 by rows), or \"position\" with x, y, z and "
         "\"orientation\" with x, y, z, w");
}

std::span<const std::string> keys_of_poses() {
  static const std::vector<std::string> kKeys{"id",          "tool",     "solids",
                                              "pose",        "matrix",   "transform_matrix",
                                              "transform",   "position", "orientation",
                                              "translation", "rotation", "time",
                                              "timestamp",   "stamp",    "t"};
  return kKeys;
}

namespace {

// True if one key is written nearly as another. Short words have others beside them, such as "time"
// has "type": of these a letter is added or left out, of long ones two may be wrong.
bool is_misspelt(const std::string& key, const std::string& meant) {
  constexpr std::size_t kShort = 6, kLong = 8, kLongest = 30;  // letters
  if (meant.size() < 3 || key.size() > kLongest) return false;
  if (meant.size() < kShort && key.size() == meant.size()) return false;
  return file::edits_between(key, meant) <= (meant.size() < kLong ? 1 : 2);
}

}  // namespace

void refuse_misspelt_keys(const json& object) {
  const auto known = keys_of_poses();
  for (const auto& [key, value] : object.items()) {
    if (std::ranges::count(known, key) > 0) continue;
    const auto meant = std::ranges::find_if(
        known, [&](const std::string& name) { return is_misspelt(key, name); });
    if (meant != known.end())
      refuse("there is no key '" + file::shown(key) + "'", {}, "is '" + *meant + "' meant?");
  }
}

std::vector<Pose> poses_of_solids(const json& list, double& largest_deviation) {
  if (!list.is_array() || list.empty() || list.front().is_number())
    refuse("\"solids\" is no list of poses", {},
           "write one for each solid, [[tx,ty,tz,qx,qy,qz,qw], …]");
  std::vector<Pose> poses;
  for (const json& item : list) {
    try {
      double deviation = 0;
      poses.push_back(from_untimed(
          item.is_object() ? pose_of_object(item).numbers : numbers_of(item), &deviation));
      largest_deviation = std::max(largest_deviation, deviation);
    } catch (const Error& fault) {
      refuse("solid " + std::to_string(poses.size()) + " of \"solids\": " + fault.problem(), {},
             fault.hint());
    }
  }
  return poses;
}

std::optional<Pose> camera_of_object(const json& object, double* deviation) {
  if (object.contains("extrinsic")) return from_extrinsic(object["extrinsic"], deviation);
  for (const char* key : {"matrix", "transform_matrix", "camera_pose", "pose", "transform"}) {
    if (!object.contains(key)) continue;
    if (object[key].is_object())
      return from_untimed(pose_of_object(object[key]).numbers, deviation);
    const std::vector<double> n = numbers_of(object[key]);
    return n.size() == kQuaternionPose ? from_untimed(n, deviation)
                                       : from_matrix(n, kNoCameraMatrix, deviation);
  }
  const auto pose = pose_of_ros(object);
  return pose ? std::optional(from_untimed(pose->numbers, deviation)) : std::nullopt;
}

}  // namespace vpm
