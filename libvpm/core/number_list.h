// Parses the lists of numbers that options and poses are written in.
#pragma once

#include <string>
#include <vector>

namespace vpm {

// Returns the numbers of "1,2,3", "1 2 3" or "[1, 2, 3]". Throws Error(invalid_argument), naming
// the word at fault, if one is none, nothing stands between two commas, or a bracket has no other.
std::vector<double> numbers_from_text(const std::string& text);

}  // namespace vpm
