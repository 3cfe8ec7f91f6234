#include "tools/common/number_checks.h"

#include <vpm/error.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

namespace vpm::tools {
namespace {

// Returns `text` as a number in the way CLI11 reads it; nothing where it is none.
template <class Number>
std::optional<Number> number_of(const std::string& text) {
  Number value{};
  if (!CLI::detail::lexical_cast(text, value)) return std::nullopt;
  return value;
}

// True for 010 and the like, which CLI11 would read as octal.
bool has_leading_zero(const std::string& text) {
  return text.size() > 1 && text[0] == '0' && text.find_first_not_of("0123456789") == text.npos;
}

std::string words_of(double value) {
  std::ostringstream words;
  words << value;
  return words.str();
}

}  // namespace

NumberCheck positive_number() {
  return [](const std::string& text) -> std::string {
    const std::optional<double> value = number_of<double>(text);
    if (value && *value > 0 && std::isfinite(*value)) return {};
    return text + " is not a number greater than 0";
  };
}

NumberCheck number_in(double low, double high) {
  return [low, high](const std::string& text) -> std::string {
    const std::optional<double> value = number_of<double>(text);
    if (value && *value >= low && *value <= high) return {};
    return text + " is not a number from " + words_of(low) + " to " + words_of(high);
  };
}

NumberCheck whole_number_in(long long low, long long high) {
  return [low, high](const std::string& text) -> std::string {
    const std::optional<long long> value = number_of<long long>(text);
    if (has_leading_zero(text)) return text + " begins with a zero; write it without";
    if (value && *value >= low && *value <= high) return {};
    return text + " is not a whole number from " + std::to_string(low) + " to " +
           std::to_string(high);
  };
}

double fraction_from_text(const std::string& text, const std::string& option) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  const std::string_view unit(stop, static_cast<std::size_t>(end - stop));
  if (fault != std::errc() || (!unit.empty() && unit != "%") || !(value > 0)) {
    throw Error(ErrorKind::invalid_argument,
                option + " " + text + ": give a fraction of the tool's volume like 0.5% or 0.005");
  }
  return unit.empty() ? value : value / 100;
}

}  // namespace vpm::tools
