#include "tools/common/json_config.h"

#include <nlohmann/json.hpp>
#include <set>

namespace vpm::tools {
namespace {

using nlohmann::json;

std::string text_of(const json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

// Options that steer one call and make no sense in a file.
bool is_kept(const std::string& name) {
  static const std::set<std::string> kOneCall{"help", "version", "config", "dump-config"};
  return !name.empty() && kOneCall.count(name) == 0;
}

json value_of(const CLI::Option& option) {
  if (option.get_expected_max() == 0) return option.count() > 0;
  const std::vector<std::string> given = option.results();
  const auto as_json = [](const std::string& text) {
    const json parsed = json::parse(text, nullptr, false);
    return parsed.is_number() || parsed.is_boolean() ? parsed : json(text);
  };
  if (given.size() == 1) return as_json(given.front());
  json list = json::array();
  for (const std::string& text : given) list.push_back(as_json(text));
  return list;
}

}  // namespace

std::string JsonConfig::to_config(const CLI::App* app, bool default_also, bool, std::string) const {
  json config = json::object();
  for (const CLI::Option* option : app->get_options()) {
    const std::string name =
        option->get_lnames().empty() ? option->get_name(true) : option->get_lnames().front();
    if (!option->get_configurable() || !is_kept(name)) continue;
    if (option->count() > 0) {
      config[name] = value_of(*option);
    } else if (default_also && !option->get_default_str().empty()) {
      const json parsed = json::parse(option->get_default_str(), nullptr, false);
      config[name] =
          parsed.is_number() || parsed.is_boolean() ? parsed : json(option->get_default_str());
    }
  }
  return config.dump(2) + "\n";
}

std::vector<CLI::ConfigItem> JsonConfig::from_config(std::istream& input) const {
  json config;
  try {
    config = json::parse(input);
  } catch (const json::exception& fault) {
    throw CLI::FileError(std::string("the configuration is not JSON: ") + fault.what());
  }
  if (!config.is_object())
    throw CLI::FileError("the configuration must be a JSON object of options");
  std::vector<CLI::ConfigItem> items;
  for (const auto& [key, value] : config.items()) {
    CLI::ConfigItem item;
    item.name = key;
    if (value.is_array()) {
      for (const json& element : value) item.inputs.push_back(text_of(element));
    } else if (value.is_null() || value.is_object()) {
      throw CLI::FileError("the configuration's '" + key +
                           "' must be a number, a string, true, false or a list");
    } else {
      item.inputs.push_back(text_of(value));
    }
    items.push_back(item);
  }
  return items;
}

}  // namespace vpm::tools
