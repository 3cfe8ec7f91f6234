#include "libvpm/core/number_list.h"

#include <algorithm>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

constexpr const char* kBlank = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

}  // namespace

std::vector<double> numbers_from_text(const std::string& text) {
  std::string_view list = trimmed(text);
  const bool opens = list.starts_with('['), closes = list.ends_with(']');
  if (opens && closes) list = trimmed(list.substr(1, list.size() - 2));
  const auto fail = [&](std::string_view word) {
    throw Error(ErrorKind::invalid_argument,
                "'" + std::string(word) + "' is not a number in '" + text + "'");
  };
  std::vector<double> numbers;
  for (;;) {
    const std::size_t end = std::min(list.find_first_of(", \t\r\n"), list.size());
    const std::string_view word = list.substr(0, end);
    const auto number = number_from_text<double>(word);
    if (!number || opens != closes) fail(word);
    numbers.push_back(*number);
    list = trimmed(list.substr(end));
    if (list.empty()) return numbers;
    if (list.starts_with(',')) list = trimmed(list.substr(1));
  }
}

}  // namespace vpm
