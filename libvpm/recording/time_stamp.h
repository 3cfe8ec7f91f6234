// Times as recorders write them.
#pragma once

namespace vpm {

// Returns seconds of a time that may count seconds, milli-, micro- or nanoseconds since 1970: 10^11
// s are the year 5138, and smaller ones are before 1973 in the next unit.
inline double seconds_of_stamp(double stamp) {
  if (stamp > 1e17) return 1e-9 * stamp;
  if (stamp > 1e14) return 1e-6 * stamp;
  return stamp > 1e11 ? 1e-3 * stamp : stamp;
}

}  // namespace vpm
