// Checks of the numbers that options take. CLI11's own let NaN pass and write bounds in 309 digits.
#pragma once

#include <functional>
#include <string>

namespace vpm::tools {

using NumberCheck = std::function<std::string(const std::string& text)>;

NumberCheck positive_number();  // finite
NumberCheck number_in(double low, double high);
NumberCheck whole_number_in(long long low, long long high);

}  // namespace vpm::tools
