#include "libvpm/import/calibration_text.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/json_text.h"
#include "libvpm/file/text.h"
#include "libvpm/import/intrinsics_file.h"

namespace vpm {

using nlohmann::json;

std::vector<double> plain_numbers(std::string_view text) {
  std::vector<double> numbers;
  file::TextCursor cursor(text);
  while (const auto line = cursor.line()) {
    const std::string_view row = line->substr(0, line->find('#'));
    for (const std::string_view word : file::split_words(row, " \t\r\n\v\f,;[]")) {
      const std::optional<double> number = file::to_number(word);
      if (!number) return {};
      numbers.push_back(*number);
    }
  }
  return numbers;
}

namespace {

struct NamedNumbers {
  std::string name;
  std::vector<double> numbers;  // those that follow the name
};

// Splits a line into names and the numbers behind each; numbers before the first name get none.
std::vector<NamedNumbers> split_at_names(std::string_view line) {
  const std::string_view row = line.substr(0, line.find('#'));
  std::vector<NamedNumbers> parts;
  for (const std::string_view word : file::split_words(row, " \t\r\n\v\f,;:=")) {
    const std::optional<double> number = file::to_number(word);
    if (!number || parts.empty()) parts.push_back({number ? "" : std::string(word), {}});
    if (number) parts.back().numbers.push_back(*number);
  }
  return parts;
}

// Returns the object of a text of lines "fx = 150", "P2: 150 0 …", or of names over a line of their
// numbers; null for other texts.
json named_numbers(std::string_view text) {
  json found = json::object();
  const auto add = [&](const std::string& name, json value) {
    if (found.contains(name))
      refuse("it gives " + file::shown(name, 40) + " twice", {}, "leave one of them out");
    found[name] = std::move(value);
  };
  file::TextCursor cursor(text);
  std::vector<NamedNumbers> names;  // those of the line before, if it has nothing else
  while (const auto line = cursor.line()) {
    const std::vector<NamedNumbers> parts = split_at_names(*line);
    if (parts.empty()) continue;
    const bool are_names = std::ranges::all_of(parts, [](auto& p) { return p.numbers.empty(); });
    const bool are_values =
        std::ranges::none_of(parts, [](auto& p) { return p.name.empty() || p.numbers.empty(); });
    if (names.empty() && are_values) {
      for (const auto& [name, numbers] : parts)
        add(name, numbers.size() == 1 ? json(numbers[0]) : json(numbers));
    } else if (names.empty() && are_names) {
      names = parts;
    } else if (parts[0].name.empty() && parts[0].numbers.size() == names.size()) {
      for (std::size_t k = 0; k < names.size(); ++k) add(names[k].name, parts[0].numbers[k]);
      names.clear();
    } else {
      return nullptr;
    }
  }
  return names.empty() && !found.empty() ? found : json(nullptr);
}

}  // namespace

json parse_calibration(std::string_view text, const std::string& name) {
  const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const bool is_json = text.substr(first).starts_with('{');
  try {
    if (is_json) return file::parse_json(text);
    if (json named = named_numbers(text); named.is_object()) return named;
  } catch (const Error& fault) {
    refuse(fault.problem(), name, fault.hint());
  }
  return parse_yaml(text, name);
}

}  // namespace vpm
