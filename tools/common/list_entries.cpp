#include "tools/common/list_entries.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string_view>

#include "libvpm/core/error.h"
#include "libvpm/file/json_text.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "tools/common/error_text.h"

namespace vpm::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::string_view kPlace = "{}";
// Options that name an output, --output first.
constexpr const char* kOutputs[] = {"output", "report", "export", "stats", "spheres-out", "view"};

bool is_output(const std::string& option) {
  return std::ranges::count(kOutputs, option) > 0;
}

// Which entries a shard has: those whose place in the list is `first` plus a multiple of `step`.
struct Shard {
  std::size_t first = 0, step = 1;
};

Shard shard_of(const std::string& text) {
  if (text.empty()) return {};
  unsigned long i = 0, n = 0;
  int end = 0;
  const bool is_read = std::sscanf(text.c_str(), "%9lu/%9lu%n", &i, &n, &end) == 2;
  if (!is_read || static_cast<std::size_t>(end) != text.size() || i < 1 || i > n)
    refuse_usage("--shard " + text + ": give i/n, such as 1/4 for the first of four");
  return {i - 1, n};
}

// Returns the input's path from the working folder, or from the root if it is elsewhere, without
// its ending: two inputs of one name stay apart by their folders.
std::string name_of(const std::string& input) {
  const fs::path here = fs::current_path();
  fs::path whole = (here / input).lexically_normal();
  if (!whole.has_filename()) whole = whole.parent_path();  // a folder with a slash at its end
  fs::path name = whole.lexically_relative(here);
  if (name.empty() || *name.begin() == "..") name = whole.relative_path();
  return name.replace_extension().string();
}

std::string with_name(std::string text, const std::string& name) {
  for (std::size_t k = 0; (k = text.find(kPlace, k)) != text.npos; k += name.size())
    text.replace(k, kPlace.size(), name);
  return text;
}

void put_name(Json& value, const std::string& name) {
  if (value.is_string()) value = with_name(value.get<std::string>(), name);
  if (value.is_array())
    for (Json& part : value) put_name(part, name);
}

// Returns the first text of the value, or of the values in it; empty if there is none.
std::string first_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  for (const Json& part : value.is_structured() ? value : Json())
    if (std::string text = first_text(part); !text.empty()) return text;
  return {};
}

// Returns the options of a line.
Json options_of(const std::string& line, const std::string& place, const ListedInput& input) {
  return naming(place, [&]() -> Json {
    if (printable(line, line.size()) != line)
      refuse("the name is not plain text in UTF-8", {}, "give the file another name");
    if (line[0] != '{') return Json{{input.option, line}};
    Json options = file::parse_json(line);
    if (first_text(options).empty())
      refuse(
          "the line names no file", {},
          "give options as in a configuration: {\"" + std::string(input.option) + "\":\"FILE\"}");
    return options;
  });
}

// Lets the outputs of all entries have names of their own.
void place_outputs(Json& options, const ListedInput& input) {
  for (const char* const output : kOutputs) {
    if (!options.contains(output)) continue;
    std::string name = options[output];
    if (name.find(kPlace) != name.npos) continue;
    if (output != std::string_view("output"))
      refuse_usage("--" + std::string(output) + " " + name +
                   " is one file for all of --list: put {} in its name, for which each input's "
                   "name is put");
    std::error_code fault;
    if (name == "-" || (fs::exists(name, fault) && !fs::is_directory(name, fault)))
      refuse_usage("--output " + name + " is no folder: name one for the outputs of --list");
    options[output] = (fs::path(name) / kPlace).string() + input.ending;
  }
}

// Returns the options of every run: those that are given, but for these of lists.
Json common_options(const Program& program, const ListArguments& a, const ListedInput& input) {
  Json options = Json::parse(program.configuration());
  for (const char* const name : {"list", "shard", "jobs"}) options.erase(name);
  if (options.contains(input.option))
    refuse_usage(std::string(input.option) + " is what --list " + a.list +
                 " names: leave one of them out");
  if (options.value("resume", false))
    refuse_usage("--list goes on by itself after what is done: leave --resume out");
  if (!options.contains("output"))
    refuse_usage("--list writes a file for each input: give -o FOLDER");
  place_outputs(options, input);
  return options;
}

ListEntry entry_of(const Json& common, const Json& all, const Json& line,
                   const ListedInput& input) {
  ListEntry entry;
  entry.input = first_text(line.contains(input.option) ? line[input.option] : line);
  entry.options = common;
  entry.options.update(line);
  entry.result = all;
  entry.result.update(line);
  const std::string stem = fs::path(entry.input).replace_extension().string();
  const std::string name = name_of(entry.input);
  for (Json* options : {&entry.options, &entry.result})
    for (auto& [option, value] : options->items()) put_name(value, is_output(option) ? name : stem);
  for (const char* const output : kOutputs) entry.result.erase(output);
  entry.result.erase(input.option);
  return entry;
}

void refuse_shared_outputs(const std::string& list, const std::vector<ListEntry>& entries) {
  std::map<std::string, std::string> inputs;
  for (const ListEntry& entry : entries)
    for (const std::string& output : entry.outputs()) {
      const auto [place, is_new] =
          inputs.emplace(fs::path(output).lexically_normal().string(), entry.input);
      if (!is_new)
        refuse_usage(list + ": " + place->second + " and " + entry.input +
                     " would both be written to " + output +
                     "; name another output in a line such as {\"output\":\"FILE\",...}");
    }
}

void add_texts(const Json& value, std::vector<std::string>& texts) {
  if (value.is_string()) texts.push_back(value);
  if (value.is_array())
    for (const Json& part : value) add_texts(part, texts);
}

}  // namespace

std::vector<std::string> ListEntry::outputs() const {
  std::vector<std::string> names;
  for (const char* const output : kOutputs)
    if (options.contains(output)) names.push_back(options[output]);
  return names;
}

std::vector<std::string> ListEntry::inputs() const {
  std::vector<std::string> names;
  for (const auto& [option, value] : options.items())
    if (!is_output(option)) add_texts(value, names);
  return names;
}

std::vector<ListEntry> read_list(const Program& program, const ListArguments& a,
                                 const ListedInput& input) {
  const Shard shard = shard_of(a.shard);
  const Json common = common_options(program, a, input), all = program.parameters();
  const std::vector<std::byte> bytes = file::read_all(a.list);
  const std::string name = a.list == "-" ? "standard input" : a.list;
  const std::string text = file::utf8_of(file::without_byte_order_mark(file::as_text(bytes)));
  file::TextCursor cursor(text);
  std::vector<ListEntry> entries;
  std::size_t number = 0;
  while (const auto line = cursor.line()) {
    ++number;
    if (line->empty() || line->front() == '#') continue;
    const std::string place = name + ":" + std::to_string(number);
    entries.push_back(entry_of(common, all, options_of(std::string(*line), place, input), input));
  }
  if (entries.empty()) refuse("the list is empty", name, "give the name of an input on each line");
  refuse_shared_outputs(name, entries);
  std::vector<ListEntry> part;
  for (std::size_t k = shard.first; k < entries.size(); k += shard.step)
    part.push_back(std::move(entries[k]));
  return part;
}

}  // namespace vpm::tools
