// --help and --help-all: options in groups, lines of at most 100 columns, examples, exit codes.
//
// scripts/command_docs.py makes the completions of shells of what --help-all prints.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace vpm::tools {

// Where a group of options is shown: by --help and --help-all, or by --help-all alone.
enum class Group { usual, rare };

// Begins a group: the options that are declared next stand under this title. The words of an option
// in both helps are its description, its default where it captures that, and what it takes: its
// option_text(), else the names of its check, else N for whole numbers, X for others and FILE.
void begin_group(CLI::App& app, const std::string& title, Group shown = Group::usual);

// Makes both helps of the options as they are declared.
class Help : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;

  void add_group(const std::string& title, Group shown);
  void set_examples(std::vector<std::string> commands) { examples_ = std::move(commands); }
  void add_exit_code(int code, std::string meaning) { exit_codes_[code] = std::move(meaning); }

 private:
  std::set<std::string> rare_;
  std::vector<std::string> examples_;
  std::map<int, std::string> exit_codes_{{0, "what was asked for is done"},
                                         {1, "an input was refused"},
                                         {2, "wrong usage"},
                                         {3, "not there: a device, or a part that was not built"},
                                         {4, "an output cannot be written"}};
};

// Titles of the groups that all programs have, which are shown last.
inline constexpr const char* kCommonGroup = "Common to all programs";
inline constexpr const char* kConfigGroup = "Configurations and messages";

}  // namespace vpm::tools
