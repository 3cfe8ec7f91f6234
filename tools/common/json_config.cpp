#include "tools/common/json_config.h"

#include <vpm/error.h>

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libvpm/file/json_text.h"
#include "libvpm/file/text.h"

namespace vpm::tools {
namespace {

using nlohmann::json;

std::string text_of(const std::string& key, const json& value) {
  if (!value.is_string()) return value.dump();
  const auto& text = value.get_ref<const std::string&>();
  // A path would end there for the system, but not for the checks before.
  if (text.find('\0') != text.npos)
    throw CLI::FileError("the configuration's '" + key + "' has a character of code 0 in it");
  return text;
}

// Returns a configuration of at most a million bytes, far more than all options take.
std::string whole_text(std::istream& input) {
  constexpr std::size_t kLongest = 1'000'000;
  std::string text;
  std::array<char, 4096> block{};
  do {
    input.read(block.data(), block.size());
    text.append(block.data(), static_cast<std::size_t>(input.gcount()));
  } while (input && text.size() <= kLongest);
  if (text.size() > kLongest)
    throw CLI::FileError("the configuration is longer than " + std::to_string(kLongest) + " bytes");
  return text;
}

// True if a value of `option` is written as a JSON number; a file may be called 1e5 and is not.
bool takes_numbers(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.rfind("INT", 0) == 0 || type.rfind("UINT", 0) == 0 || type.rfind("FLOAT", 0) == 0;
}

// Returns `text` as a JSON number if `option` takes numbers, as a string otherwise. Converts .001
// and 1., which CLI11 reads and JSON does not.
json number_or_text(const CLI::Option& option, const std::string& text) {
  if (!takes_numbers(option)) return text;
  json parsed = json::parse(text, nullptr, false);
  if (parsed.is_number()) return parsed;
  double value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = fault == std::errc() && end == text.data() + text.size();
  return is_number && std::isfinite(value) ? json(value) : json(text);
}

json value_of(const CLI::Option& option) {
  if (option.get_expected_max() == 0) return option.as<bool>();
  const std::vector<std::string>& given = option.results();
  if (given.size() == 1) return number_or_text(option, given.front());
  json list = json::array();
  for (const std::string& text : given) list.push_back(number_or_text(option, text));
  return list;
}

}  // namespace

std::string config_key(const CLI::Option& option) {
  return option.get_lnames().empty() ? option.get_name(true) : option.get_lnames().front();
}

std::string JsonConfig::to_config(const CLI::App* app, bool default_also, bool, std::string) const {
  json config = json::object();
  for (const CLI::Option* option : app->get_options()) {
    const std::string key = config_key(*option);
    if (!option->get_configurable() || key.empty()) continue;
    if (option->count() > 0) {
      config[key] = value_of(*option);
      // Leaves out options whose value may be omitted: their default string is that value.
    } else if (default_also && option->get_expected_min() > 0 &&
               !option->get_default_str().empty()) {
      const json parsed = json::parse(option->get_default_str(), nullptr, false);
      config[key] = parsed.is_array() ? parsed : number_or_text(*option, option->get_default_str());
    }
  }
  return config.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

std::vector<CLI::ConfigItem> JsonConfig::from_config(std::istream& input) const {
  const std::string text = whole_text(input);
  json config;
  try {
    config = file::parse_json(file::utf8_of(text));
  } catch (const Error& fault) {
    throw CLI::FileError("the configuration is " + fault.problem() +
                         (fault.hint().empty() ? "" : "; " + fault.hint()));
  }
  if (!config.is_object())
    throw CLI::FileError("the configuration must be a JSON object of options");
  std::vector<CLI::ConfigItem> found;
  for (const auto& [key, value] : config.items()) {
    if (key.find('\0') != key.npos)
      throw CLI::FileError("a name in the configuration has a character of code 0 in it");
    CLI::ConfigItem item;
    item.name = key;
    const json list = value.is_array() ? value : json::array({value});
    for (const json& element : list) {
      if (element.is_null() || element.is_structured()) {
        throw CLI::FileError("the configuration's '" + key +
                             "' must be a number, a string, true, false or a list of these");
      }
      item.inputs.push_back(text_of(key, element));
    }
    found.push_back(item);
  }
  return found;
}

}  // namespace vpm::tools
