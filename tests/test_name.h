// Names of the cases of parameterised tests.
#pragma once

#include <cctype>
#include <string>

namespace vpm::test {

// Returns a name that GoogleTest accepts: keeps letters and digits and replaces all else by '_'.
inline std::string test_name(std::string text) {
  for (char& c : text) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return text;
}

}  // namespace vpm::test
