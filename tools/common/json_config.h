#pragma once

#include <CLI/CLI.hpp>

namespace vpm::tools {

// Reads and writes options as JSON for CLI11. Keys are the long option names without dashes, or the
// names of positional arguments, e.g. {"spheres": 1000}. formats/schemas/config.*.json describe
// them.
class JsonConfig : public CLI::Config {
 public:
  std::string to_config(const CLI::App* app, bool default_also, bool write_description,
                        std::string prefix) const override;
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;
};

// Returns the key that stands for `option` in a configuration.
std::string config_key(const CLI::Option& option);

}  // namespace vpm::tools
