// Reads the numbers of a pose that is written in JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "libvpm/core/error.h"

namespace vpm {

// Returns the numbers of a list, or of a list of lists, row by row. Throws a refusal at anything
// else.
inline std::vector<double> numbers_of(const nlohmann::json& value) {
  if (!value.is_array()) refuse("a pose must be a list of numbers");
  std::vector<double> numbers;
  for (const nlohmann::json& item : value) {
    for (const nlohmann::json& number : item.is_array() ? item : nlohmann::json::array({item})) {
      if (!number.is_number()) refuse("a pose must be a list of numbers");
      numbers.push_back(number.get<double>());
    }
  }
  return numbers;
}

}  // namespace vpm
