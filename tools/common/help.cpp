#include "tools/common/help.h"

#include <algorithm>
#include <cctype>
#include <memory>
#include <sstream>

namespace vpm::tools {
namespace {

constexpr std::size_t kLine = 100, kMargin = 2, kColumn = 28;  // characters

// Adds a word to the text, on a new line that begins in this column where the last one is full.
void add_word(std::string& text, const std::string& word, std::size_t column) {
  const std::size_t width = text.size() - (text.rfind('\n') + 1);  // npos + 1 is 0
  if (width + 1 + word.size() > kLine) text += "\n" + std::string(column, ' ') + word;
  // The first word of a column has blanks before it already.
  else
    text += (text.ends_with(' ') ? "" : " ") + word;
}

// Returns a line of the help: `left`, such as the names of an option, and beside it `right`, which
// goes on in further lines where it is long.
std::string in_columns(const std::string& left, const std::string& right) {
  std::string text = std::string(kMargin, ' ') + left;
  text += text.size() + 2 > kColumn ? "\n" + std::string(kColumn, ' ')
                                    : std::string(kColumn - text.size(), ' ');
  std::istringstream words(right);
  for (std::string word; words >> word;) add_word(text, word, kColumn);
  return text + "\n";
}

// Returns what the option takes; empty for a flag.
std::string what_it_takes(const CLI::Option& option) {
  if (option.get_expected_max() == 0) return {};
  if (!option.get_option_text().empty()) return option.get_option_text();
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.rfind('}');
  if (open != type.npos && close != type.npos) {  // the names that a check allows
    std::string names = type.substr(open + 1, close - open - 1);
    std::replace(names.begin(), names.end(), ',', '|');
    return names;
  }
  if (type.starts_with("INT") || type.starts_with("UINT")) return "N";
  return type.starts_with("FLOAT") ? "X" : "FILE";
}

std::string in_capitals(std::string name) {
  for (char& letter : name)
    letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  return name;
}

// Returns the names of an option, and what it takes. Long names after the first are old ones.
std::string names_of(const CLI::Option& option) {
  if (option.get_positional()) return in_capitals(option.get_name(true));
  std::string names;
  for (const std::string& name : option.get_snames()) names += "-" + name + ", ";
  if (!option.get_lnames().empty()) names += "--" + option.get_lnames().front() + ", ";
  names.resize(names.size() - 2);
  const std::string value = what_it_takes(option);
  return value.empty() ? names : names + " " + value;
}

std::string words_of(const CLI::Option& option) {
  std::string words = option.get_description();
  if (option.get_required()) words += " (required)";
  if (option.get_expected_min() > 0 && !option.get_default_str().empty())
    words += " (default: " + option.get_default_str() + ")";
  return words;
}

std::vector<const CLI::Option*> positionals_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

// Returns the titles in the order in which their options were declared, those of all programs last.
std::vector<std::string> titles_of(const CLI::App& app) {
  std::vector<std::string> titles = app.get_groups();
  std::erase(titles, "");  // options that are gone
  std::stable_partition(titles.begin(), titles.end(), [](const std::string& title) {
    return title != kCommonGroup && title != kConfigGroup;
  });
  return titles;
}

// Returns the title and the options below it; empty without options.
std::string section(const CLI::App& app, const std::string& title) {
  const auto options = app.get_options([&](const CLI::Option* option) {
    return option->get_group() == title && !option->get_positional();
  });
  std::string text = options.empty() ? "" : "\n" + title + ":\n";
  for (const CLI::Option* option : options)
    text += in_columns(names_of(*option), words_of(*option));
  return text;
}

}  // namespace

void begin_group(CLI::App& app, const std::string& title, Group shown) {
  app.option_defaults()->group(title);
  const auto help = std::dynamic_pointer_cast<Help>(app.get_formatter());
  if (help) help->add_group(title, shown);
}

void Help::add_group(const std::string& title, Group shown) {
  if (shown == Group::rare) rare_.insert(title);
}

std::string Help::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  const bool has_all = mode == CLI::AppFormatMode::All;
  const auto positionals = positionals_of(*app);
  std::string text = app->get_description() + "\n\nUsage: " + name + " [OPTIONS]";
  for (const CLI::Option* option : positionals) text += " " + names_of(*option);
  text += "\n";
  if (!positionals.empty()) text += "\nInput:\n";
  for (const CLI::Option* option : positionals)
    text += in_columns(names_of(*option), words_of(*option));
  for (const std::string& title : titles_of(*app))
    if (has_all || !rare_.contains(title)) text += section(*app, title);
  if (!examples_.empty()) text += "\nExamples:\n";
  for (const std::string& command : examples_) text += "  " + command + "\n";
  text += "\nExit codes:\n";
  for (const auto& [code, meaning] : exit_codes_)
    text += "  " + std::to_string(code) + (code < 10 ? "   " : "  ") + meaning + "\n";
  if (!has_all && !rare_.empty()) text += "\nMore options: " + name + " --help-all\n";
  return text;
}

}  // namespace vpm::tools
