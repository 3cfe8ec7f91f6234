// Declares what the library says of data that it took, though they may not be what was meant.
#pragma once

#include <string>
#include <vector>

namespace vpm {

// Plain English, one sentence with its cure. Parameters and functions stand in backquotes, as in
// the texts of Error; the file is not named, since the caller knows it.
struct Remark {
  bool is_warning = false;  // the result is likely not what was meant; otherwise a note
  std::string text;
};

using Remarks = std::vector<Remark>;

}  // namespace vpm
