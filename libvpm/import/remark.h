// Holds what a reader says about a file that it could read.
#pragma once

#include <string>
#include <vector>

namespace vpm {

// A text like those of Error: options in backquotes, and no name of the file, which the caller puts
// before it.
struct Remark {
  bool is_warning = false;  // the result is likely not what was meant
  std::string text;
};

using Remarks = std::vector<Remark>;

inline void append(Remarks& remarks, const Remarks& more) {
  remarks.insert(remarks.end(), more.begin(), more.end());
}

}  // namespace vpm
