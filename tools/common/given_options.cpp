#include "tools/common/given_options.h"

namespace vpm::tools {
namespace {

// True if both are the same text or the same number.
bool is_same_value(const std::string& a, const std::string& b) {
  double x = 0, y = 0;
  if (CLI::detail::lexical_cast(a, x) && CLI::detail::lexical_cast(b, y)) return x == y;
  return a == b;
}

}  // namespace

bool is_given(const CLI::App& app, const char* name) {
  const CLI::Option& option = *app.get_option(name);
  if (option.count() == 0) return false;
  if (option.get_expected_max() == 0) return option.as<bool>();
  if (option.get_expected_min() == 0) return true;  // its default is that of a value left out
  return !is_same_value(option.results().back(), option.get_default_str());
}

}  // namespace vpm::tools
