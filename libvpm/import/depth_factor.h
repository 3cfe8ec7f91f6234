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

// Returns the factor in an object of a calibration; nothing if it has none that depth images use.
std::optional<DepthFactor> depth_factor_in(const Fields& fields);

// Compares the factor that a file of intrinsics tells with the one that the caller gave, in units
// per metre. Returns a note if both are there and differ: the file's is not used. Returns a warning
// if the caller gave none and the file's is neither 1000 (millimetres) nor 1 (metres), which depth
// images have without being told. Else returns nothing.
Remarks unused_factor(const std::optional<DepthFactor>& factor,
                      const std::optional<double>& units_per_metre);

}  // namespace vpm
