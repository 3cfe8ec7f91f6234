#include "libvpm/recording/pose_columns.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <span>
#include <string_view>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/pose_numbers.h"

namespace vpm {
namespace {

// Tells what a word of a line of names stands for.
enum class Part {
  other,
  label,   // no column: "format:", "pose"
  column,  // surely one, which is not used: "id"
  time,
  position,
  quaternion,
  letter,        // x, y, z or w alone: what else is named tells of what
  unknown_order  // q0, qi: conventions differ
};

struct Name {
  Part part = Part::other;
  std::size_t axis = 0;         // counts x, y, z, w from 0
  Part letters = Part::letter;  // tells what single letters after this label are
};

constexpr std::string_view kAxes = "xyzw", kSeparators = "._/-";

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// Returns what the letters after a noun, or at its end, are: "orientation", "pos"; letter for other
// words.
Part part_of_noun(std::string_view noun) {
  if (is_one_of(noun, {"quaternion", "quat", "orientation", "orient", "rotation", "rot", "qvec"}))
    return Part::quaternion;
  if (is_one_of(noun, {"position", "pos", "translation", "trans", "tvec", "location", "loc", "pose",
                       "tool", "tip", "point"}))
    return Part::position;
  return Part::letter;
}

// Returns the same for what stands before the axis in a name: "t", "q_rs", "pose.orientation".
Part part_of_stem(std::string_view stem) {
  const std::size_t end = std::min(stem.find_first_of(kSeparators), stem.size());
  Part part = part_of_noun(stem.substr(0, end));
  if (is_one_of(stem.substr(0, end), {"q", "o", "r"})) return Part::quaternion;
  if (is_one_of(stem.substr(0, end), {"t", "p"})) return Part::position;
  for (std::size_t at = end; at < stem.size();) {  // the last noun is the most specific
    const std::size_t next = std::min(stem.find_first_of(kSeparators, at + 1), stem.size());
    const Part found = part_of_noun(stem.substr(at + 1, next - at - 1));
    if (found != Part::letter) part = found;
    at = next;
  }
  return part;
}

bool is_time(std::string_view name) {
  return name.starts_with("time") || name.starts_with("stamp") || name.ends_with("stamp") ||
         is_one_of(name, {"t", "sec"});
}

// Returns what a name that ends in an axis or a number is: "tx", "q_rs_w []", "q0".
Name axis_named(std::string_view name) {
  const std::size_t axis = kAxes.find(name.back());
  if (name.size() == 1) return axis < 4 ? Name{Part::letter, axis} : Name{};
  std::string_view stem = name.substr(0, name.size() - 1);
  stem = stem.substr(0, stem.find_last_not_of(kSeparators) + 1);
  const Part part = part_of_stem(stem);
  if (axis < 3 && part == Part::position) return {part, axis};
  if (axis < 4 && part == Part::quaternion) return {part, axis};
  const bool is_counted = std::string_view("01234ijkrs").find(name.back()) != name.npos;
  if (is_counted && stem.starts_with('q') && part == Part::quaternion) return {Part::unknown_order};
  return {};
}

// Returns what a word in lower case stands for.
Name name_of(std::string_view word) {
  constexpr std::string_view kAround = " \t\r\"'`#%:;=";
  const bool ends_label = word.ends_with(':') || word.ends_with('=');
  word.remove_prefix(std::min(word.find_first_not_of(kAround), word.size()));
  word = word.substr(0, word.find_last_not_of(kAround) + 1);
  if (word.empty()) return {Part::label};
  if (const Name axis = axis_named(word); axis.part != Part::other) return axis;
  if (is_time(word)) return {Part::time};
  const Part letters = part_of_noun(word);
  if (letters != Part::letter) return {Part::label, 0, letters};
  if (is_one_of(word, {"id", "index", "idx", "frame", "frame_id", "image_id", "seq", "number",
                       "confidence", "score", "weight", "status", "valid"}))
    return {Part::column};
  const bool is_label =
      ends_label || is_one_of(word, {"format", "columns", "header", "fields", "data", "poses",
                                     "trajectory", "groundtruth", "and", "p", "q"});
  return {is_label ? Part::label : Part::other};
}

bool is_axis(const Name& name) {
  return name.part == Part::position || name.part == Part::quaternion || name.part == Part::letter;
}

bool holds_names(std::string_view text) {
  const auto words = file::split_words(text);
  return std::any_of(words.begin(), words.end(), [](std::string_view word) {
    const Name name = name_of(word);
    return is_axis(name) || name.part == Part::unknown_order || word.starts_with("time") ||
           word.starts_with("stamp");
  });
}

// Returns the seconds of a unit of time; empty for others.
std::optional<double> seconds_of_unit(std::string_view unit) {
  if (is_one_of(unit, {"ns", "nsec", "nanoseconds"})) return 1e-9;
  if (is_one_of(unit, {"us", "usec", "µs", "microseconds"})) return 1e-6;
  if (is_one_of(unit, {"ms", "msec", "milliseconds"})) return 1e-3;
  return std::nullopt;
}

// Takes what a closed bracket held, from `begin` on, out of the text unless it is names; "q[x]"
// becomes "q_x".
void close_bracket(std::string& text, std::size_t begin, std::optional<double>& unit) {
  const std::string inner = text.substr(begin);
  const auto words = file::split_words(inner);
  const bool is_index = words.size() == 1 && words[0].size() == 1 &&
                        std::string_view("xyzw01234").find(words[0][0]) != std::string_view::npos;
  if (is_index && begin > 0 && std::string_view("qpt").find(text[begin - 1]) != std::string::npos) {
    text.replace(begin, std::string::npos, "_" + std::string(words[0]));
  } else if (!holds_names(inner)) {
    if (!unit && words.size() == 1) unit = seconds_of_unit(words[0]);
    text.resize(begin);
  }
}

// Returns the text without brackets and the units in them; `unit`, of the time, in seconds.
std::string without_brackets(const std::string& text, std::optional<double>& unit) {
  constexpr std::size_t kMostNested = 8;  // deeper ones are no names, and would take long
  std::string plain;
  std::vector<std::size_t> begins;
  for (const char letter : text) {
    if (std::string_view("([{<").find(letter) != std::string_view::npos) {
      if (begins.size() < kMostNested) begins.push_back(plain.size());
      plain += ' ';
    } else if (std::string_view(")]}>").find(letter) != std::string_view::npos) {
      if (!begins.empty()) {
        close_bracket(plain, begins.back(), unit);
        begins.pop_back();
      }
      plain += ' ';
    } else {
      plain += letter == ';' || letter == '|' ? ',' : letter;
    }
  }
  return plain;
}

// Returns a name for each cell between commas; empty if a cell names several columns.
std::optional<std::vector<Name>> names_of_cells(const std::string& text) {
  std::vector<Name> names;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    Name cell;
    for (const std::string_view word : file::split_words({text.data() + begin, end - begin})) {
      const Name name = name_of(word);
      if (is_axis(name) && is_axis(cell)) return std::nullopt;
      if (is_axis(name) || (name.part == Part::time && !is_axis(cell))) cell = name;
      if (name.part == Part::unknown_order) cell = name;
    }
    names.push_back(cell);
    begin = end + 1;
  }
  return names;
}

// Returns a name for each word that is a column's or may be; what is before a colon is none.
std::vector<Name> names_of_words(std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  std::vector<Name> names;
  bool has_axis = false;
  for (const std::string_view word : file::split_words(text)) {
    const Name name = name_of(word);
    has_axis = has_axis || is_axis(name);
    const bool is_heading =
        name.part == Part::label && word.size() > 1 && (word.back() == ':' || word.back() == '=');
    if (is_heading && !has_axis && name.letters == Part::letter) names.clear();
    names.push_back(name);
  }
  return names;
}

// Tells what single letters are: what is not named otherwise, or what the label before them says.
void name_letters(std::vector<Name>& names) {
  const auto number_of = [&](Part part) {
    return std::count_if(names.begin(), names.end(), [&](const Name& n) { return n.part == part; });
  };
  const auto positions = number_of(Part::position), quaternions = number_of(Part::quaternion);
  Part letters = Part::letter;
  if (positions > 0) letters = Part::quaternion;
  if (quaternions > 0) letters = positions > 0 ? Part::other : Part::position;
  const bool is_by_label = letters == Part::letter;
  for (Name& name : names) {
    if (is_by_label && name.letters != Part::letter) letters = name.letters;
    if (name.part == Part::letter && (letters != Part::position || name.axis < 3))
      name.part = letters;
  }
  std::erase_if(names, [](const Name& name) { return name.part == Part::label; });
}

// Returns the order of these columns; empty if they do not name all of a pose once.
std::optional<PoseColumns> order_of(std::span<const Name> names, std::optional<double> unit) {
  PoseColumns columns;
  columns.count = names.size();
  columns.time_unit = unit;
  std::array<int, 3> positions{};
  std::array<int, 4> quaternions{};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t axis = names[i].axis;
    if (names[i].part == Part::time && !columns.time) columns.time = i;
    if (names[i].part == Part::position) {
      columns.position[axis] = i;
      ++positions[axis];
    } else if (names[i].part == Part::quaternion) {
      columns.quaternion[axis] = i;
      ++quaternions[axis];
    } else if (names[i].part == Part::letter) {
      return std::nullopt;
    }
  }
  const bool is_whole = positions == std::array{1, 1, 1} && quaternions == std::array{1, 1, 1, 1};
  return is_whole ? std::optional(columns) : std::nullopt;
}

// Returns the ways in which the names may be those of a line's numbers: all of them, or without the
// other words before, after or between the pose's.
std::vector<PoseColumns> orders_of(std::vector<Name> names, std::optional<double> unit) {
  name_letters(names);
  std::size_t first = names.size(), end = 0;
  std::vector<Name> known;
  bool has_time = false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_first_time = names[i].part == Part::time && !has_time;
    if (is_axis(names[i])) first = std::min(first, i), end = i + 1;
    if (is_axis(names[i]) || is_first_time) known.push_back(names[i]);
    has_time = has_time || is_first_time;
  }
  if (end == 0) return {};
  if (first > 0 && names[first - 1].part == Part::time) --first;
  if (end < names.size() && names[end].part == Part::time) ++end;
  const std::span<const Name> all(names);
  std::vector<PoseColumns> orders;
  for (const auto some : {std::span<const Name>(known), all.subspan(first, end - first),
                          all.subspan(first), all.first(end), all})
    if (const auto order = order_of(some, unit)) orders.push_back(*order);
  return orders;
}

// Returns the count of numbers that leaves open whether one more than the pose's is a time in front
// or one that a word names, such as "tx ty tz qw qx qy qz metres"; empty if none does.
std::optional<std::size_t> open_count(const std::vector<PoseColumns>& orders,
                                      const std::vector<Name>& words) {
  const auto has = [&](Part part) {
    return std::any_of(words.begin(), words.end(), [&](const Name& n) { return n.part == part; });
  };
  if (orders.empty() || has(Part::time) || has(Part::column)) return std::nullopt;
  const std::size_t count = orders.front().count + 1;
  const bool is_open = std::any_of(orders.begin(), orders.end(),
                                   [&](const PoseColumns& order) { return order.count == count; });
  return is_open ? std::optional(count) : std::nullopt;
}

// True if the axes are those of a quaternion x, y, z, w, or of a position and one.
bool are_axes_usual(const std::vector<std::size_t>& axes) {
  const std::vector<std::size_t> whole{0, 1, 2, 0, 1, 2, 3};
  return axes == whole || axes == std::vector<std::size_t>(whole.begin() + 3, whole.end());
}

// True if the words, which are not understood, may well tell another order than the usual one.
bool may_tell_order(const std::string& text, const std::vector<Name>& names) {
  constexpr std::size_t kNoAxis = 4;
  std::vector<std::size_t> axes;
  bool has_quaternion = false;
  for (const Name& name : names) {
    const bool is_unknown = name.part == Part::unknown_order;
    if (is_unknown || is_axis(name)) axes.push_back(is_unknown ? kNoAxis : name.axis);
    has_quaternion = has_quaternion || name.part == Part::quaternion || is_unknown ||
                     name.letters == Part::quaternion ||
                     (name.part == Part::letter && name.axis == 3);
  }
  const bool names_scalar =
      text.find("scalar") != text.npos || text.find("real part") != text.npos ||
      std::any_of(names.begin(), names.end(),
                  [](const Name& name) { return is_axis(name) && name.axis == 3; });
  const bool is_scalar_first = names_scalar && text.find("first") != text.npos;
  const bool names_quaternion = has_quaternion && axes.size() >= 3 && !are_axes_usual(axes);
  return names_quaternion || is_scalar_first || text.find("wxyz") != text.npos;
}

// True if the words name a position and, in place of a quaternion, three angles or the three parts
// of a rotation vector: "x y z roll pitch yaw", "tx ty tz rx ry rz".
bool names_angles(const std::vector<std::string_view>& words) {
  std::size_t positions = 0, angles = 0, axes = 0;
  for (const std::string_view word : words) {
    const Name name = name_of(word);
    if (name.axis == 3 && is_axis(name)) return false;  // w
    const bool is_angle =
        std::ranges::any_of(std::array{"roll", "pitch", "yaw", "euler", "rotvec"},
                            [&](std::string_view angle) { return word.find(angle) != word.npos; });
    if (is_angle)
      ++angles;
    else if (name.part == Part::quaternion && word.front() != 'r')
      return false;
    else if (name.part == Part::quaternion)
      ++axes;
    else if (is_axis(name))
      ++positions;
  }
  return positions >= 3 && (angles >= 3 || (axes == 3 && angles == 0));
}

// True if the order is that of numbers without names: time, position and quaternion x, y, z, w.
bool is_usual(const PoseColumns& columns) {
  const std::size_t first = columns.time ? 1 : 0;
  if (columns.time.value_or(0) != 0 || columns.time_unit) return false;
  for (std::size_t i = 0; i < 7; ++i)
    if ((i < 3 ? columns.position[i] : columns.quaternion[i - 3]) != first + i) return false;
  return true;
}

// Returns the order of a line that has one number more than the names, which then is a time in
// front of the pose. Empty if the names tell of a time or of another column before the pose, or if
// the other numbers do not fit them.
std::optional<PoseColumns> order_after_time(const std::vector<PoseColumns>& orders,
                                            std::size_t count) {
  const PoseColumns& all = orders.back();
  const std::size_t first =
      std::min(*std::min_element(all.position.begin(), all.position.end()),
               *std::min_element(all.quaternion.begin(), all.quaternion.end()));
  return all.time || first > 0 ? std::nullopt : fitting_order(orders, count - 1);
}

// True if the line, in lower case, has a letter of an axis or quaternion, or tells what is first.
bool may_hold_names(const std::string& line) {
  return line.find_first_of("qwxyz") != line.npos || line.find("first") != line.npos;
}

constexpr const char* kNamesHint =
    "name the columns in a comment: # tx ty tz qx qy qz qw, or qw qx qy qz";

}  // namespace

std::optional<PoseColumns> fitting_order(const std::vector<PoseColumns>& orders,
                                         std::size_t count) {
  std::optional<PoseColumns> fitting;
  for (const PoseColumns& order : orders) {
    if (order.count != count) continue;
    if (fitting && *fitting != order) return std::nullopt;
    fitting = order;
  }
  return fitting;
}

std::optional<PoseNames> names_in(const std::string& line, std::size_t number) {
  const std::string lower = file::in_lower_case(line);
  if (!may_hold_names(lower)) return std::nullopt;
  std::optional<double> unit;
  const std::string text = without_brackets(lower, unit);
  PoseNames found{number, line, {}, {}, false};
  if (text.find(',') != text.npos)
    if (const auto cells = names_of_cells(text)) found.orders = orders_of(*cells, unit);
  const std::vector<Name> words = names_of_words(text);
  if (found.orders.empty()) {
    found.orders = orders_of(words, unit);
    found.open_count = open_count(found.orders, words);
  }
  if (!found.orders.empty()) return found;
  found.has_angles = names_angles(file::split_words(text, " \t\r,#%"));
  if (!found.has_angles && !may_tell_order(text, words)) return std::nullopt;
  return found;
}

std::vector<double> in_usual_order(const std::vector<double>& numbers, const PoseNames& names) {
  const std::string line = "line " + std::to_string(names.line);
  if (names.has_angles)
    refuse(line + " names angles where a quaternion should be: " + file::shown(names.text), {},
           kAnglesHint);
  if (names.orders.empty() || names.open_count == numbers.size())
    refuse(line + " seems to tell the order of the numbers, but not clearly: " +
               file::shown(names.text),
           {}, kNamesHint);
  auto order = fitting_order(names.orders, numbers.size());
  const bool has_time_before = !order;
  if (!order) order = order_after_time(names.orders, numbers.size());
  if (!order) {
    if (is_usual(names.orders.front())) return numbers;
    refuse("found " + std::to_string(numbers.size()) + " numbers where the line of names has " +
               std::to_string(names.orders.front().count) + " (" + line + ")",
           {}, "let the names in it be those of the numbers, in their order");
  }
  std::vector<double> pose;
  if (has_time_before) pose.push_back(numbers.front());
  if (order->time) pose.push_back(order->time_unit.value_or(1) * numbers[*order->time]);
  for (const std::size_t column : order->position)
    pose.push_back(numbers[column + has_time_before]);
  for (const std::size_t column : order->quaternion)
    pose.push_back(numbers[column + has_time_before]);
  return pose;
}

}  // namespace vpm
