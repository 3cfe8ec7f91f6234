#include "tools/common/parse_message.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "libvpm/file/nearest_word.h"
#include "libvpm/file/text.h"

namespace vpm::tools {
namespace {

// Returns the option, with its dashes, that is nearly the one given or begins as it does; empty if
// none is near.
std::string nearest_option(const CLI::App& app, const std::string& given) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return file::nearest_word(given, names, 5);  // letters, with the dashes
}

// Returns "there is no option --tol; is --tool meant?", or CLI11's words if none is near.
std::string unknown_option(const CLI::App& app, const std::string& what) {
  const std::size_t begin = what.find("--");
  if (begin == what.npos) return what;
  const std::string given = what.substr(begin, what.find_first_of(" =", begin) - begin);
  const std::string best = nearest_option(app, given);
  return best.empty() ? what : "there is no option " + given + "; is " + best + " meant?";
}

// Returns the message of an option, such as --pose, whose numbers are words of their own; empty if
// there is none.
std::string numbers_apart(const CLI::App& app, std::span<const char* const> arguments) {
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    const std::string name = arguments[k];
    const CLI::Option* const option =
        name.starts_with("--") ? app.get_option_no_throw(name) : nullptr;
    if (option == nullptr || option->get_multi_option_policy() != CLI::MultiOptionPolicy::Join)
      continue;
    std::string joined;
    std::size_t end = k + 1;
    for (; end < arguments.size() && file::to_number(arguments[end]); ++end)
      joined += (joined.empty() ? "" : ",") + std::string(arguments[end]);
    if (end > k + 2)
      return name + " has its numbers apart; give them as one word: " + name + " " + joined;
  }
  return "";
}

// Returns the message of an option of one value that has several, in CLI11's words "--scale: At
// Most 1 required but received 2", in ours.
std::string too_many_values(const std::string& what) {
  const std::size_t end = what.find(": At Most 1 required");
  return end == what.npos ? what
                          : what.substr(0, end) + " has several values; leave all but one out";
}

// Returns the message of a value that is no number, in CLI11's words "Could not convert: --scale =
// mm", in ours.
std::string no_number(const CLI::App& app, const std::string& what) {
  const std::size_t begin = what.find("--"), equals = what.find(" = ");
  if (begin == what.npos || equals == what.npos || equals < begin) return what;
  const std::string name = what.substr(begin, equals - begin);
  const std::string value = what.substr(equals + 3);
  const CLI::Option* const option = app.get_option_no_throw(name);
  if (option != nullptr && option->get_expected_max() == 0)  // a flag in a configuration
    return name + " " + value + ": give true or false";
  const bool is_whole = option != nullptr && option->get_type_name().find("INT") != name.npos;
  const char* const wanted = is_whole               ? "a whole number"
                             : value.ends_with('%') ? "a fraction, such as 0.95"
                                                    : "a number without a unit, such as 0.001";
  return name + " " + value + ": give " + wanted;
}

// True if the command line has the option, which passes over a configuration's value for it then.
bool is_on(std::span<const char* const> arguments, const CLI::Option& option) {
  return std::any_of(arguments.begin(), arguments.end(), [&](const std::string_view argument) {
    const std::string name(argument.substr(0, argument.find('=')));
    const bool is_long = name.starts_with("--");
    return option.check_name(is_long ? name : name.substr(0, 2));
  });
}

// Returns "--config FILE: " if the message begins with an option that only the configuration has.
std::string source_of(const CLI::App& app, const std::string& message, const std::string& config,
                      std::span<const char* const> arguments) {
  const std::string name = message.substr(0, message.find_first_of(" :"));
  const CLI::Option* const option =
      name.starts_with("--") ? app.get_option_no_throw(name) : nullptr;
  if (config.empty() || option == nullptr || is_on(arguments, *option)) return "";
  return "--config " + config + ": ";
}

// Returns the message of a value that is refused, in our words where CLI11's are none.
std::string refused_value(const CLI::App& app, const CLI::ParseError& fault) {
  if (dynamic_cast<const CLI::ConversionError*>(&fault) != nullptr)
    return no_number(app, fault.what());
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&fault) != nullptr)
    return too_many_values(fault.what());
  return fault.what();
}

}  // namespace

std::string message_of(const CLI::App& app, const CLI::ParseError& fault, const std::string& config,
                       std::span<const char* const> arguments) {
  constexpr std::string_view kUnknownKey = "INI was not able to parse ";
  std::string what = fault.what();
  if (dynamic_cast<const CLI::FileError*>(&fault) != nullptr) {
    if (what.ends_with("was not readable (missing?)")) {
      errno = 0;
      const bool opens = ::access(config.c_str(), R_OK) == 0;
      return "--config: cannot read " + config + (opens ? "" : ": ") +
             (opens ? "" : std::strerror(errno));
    }
    return "--config " + config + ": " + what;
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&fault) != nullptr) {
    const std::string apart = numbers_apart(app, arguments);
    return apart.empty() ? unknown_option(app, what) : apart;
  }
  if (what.rfind(kUnknownKey, 0) != 0) {
    what = refused_value(app, fault);
    return source_of(app, what, config, arguments) + what;
  }
  const std::string key = what.substr(kUnknownKey.size());
  const std::string best = nearest_option(app, "--" + key);
  return "--config " + config + ": there is no option '" + key + "'" +
         (best.empty() ? "" : "; is '" + best.substr(2) + "' meant?");
}

}  // namespace vpm::tools
