// Joins the remarks of several readers about a file.
#pragma once

#include <vpm/remark.h>

namespace vpm {

inline void append(Remarks& remarks, const Remarks& more) {
  remarks.insert(remarks.end(), more.begin(), more.end());
}

}  // namespace vpm
