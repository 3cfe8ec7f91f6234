// Checks of the numbers that options take. CLI11's own checks accept NaN and print bounds in 309
// digits.
#pragma once

#include <functional>
#include <string>

namespace vpm::tools {

// Returns an empty string if `text` passes, and otherwise the message for the user.
using NumberCheck = std::function<std::string(const std::string& text)>;

// Accepts finite numbers greater than 0.
NumberCheck positive_number();

// Accepts numbers from `low` to `high`, both included.
NumberCheck number_in(double low, double high);
NumberCheck whole_number_in(long long low, long long high);

// Returns a fraction as users write it, "0.5%" or "0.005". Throws Error(invalid_argument) naming
// `option`.
double fraction_from_text(const std::string& text, const std::string& option);

}  // namespace vpm::tools
