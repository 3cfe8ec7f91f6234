// Scale of the depth images that a calibration file tells, beside intrinsics.
#pragma once

#include <optional>
#include <string>

#include "libvpm/import/calibration_fields.h"
#include "libvpm/import/remark.h"

namespace vpm {

// Scale of the depth images that a calibration tells, as ORB-SLAM, BOP and Replica do.
struct DepthFactor {
  std::string told;            // key and number: "DepthMapFactor 5000"
  std::string reading;         // how the number is understood where its key does not tell; or empty
  double units_per_metre = 0;  // finite and greater than 0
};

// Returns the factor in an object of a calibration; empty if there is none that a depth image has.
std::optional<DepthFactor> depth_factor_in(const Fields& fields);

// Returns a note that the file's factor is not used if another was given, and a warning if none was
// given and the file's is not 1000 or 1, which depth images have without being told.
Remarks unused_factor(const std::optional<DepthFactor>& factor,
                      const std::optional<double>& units_per_metre);

}  // namespace vpm
