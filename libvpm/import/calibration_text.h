// Reads the texts of calibrations: numbers, numbers with names, JSON and YAML.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace vpm {

// Returns the numbers of a text that holds nothing else; empty otherwise.
std::vector<double> plain_numbers(std::string_view text);

// Returns the values of a text of lines "fx = 150", of names over their numbers, of JSON or of
// YAML. Throws Error(refused), naming `name`, for other texts, and Error(unavailable) for YAML in
// builds without it.
nlohmann::json parse_calibration(std::string_view text, const std::string& name);

}  // namespace vpm
