// Facts of an imported scan by which people see whether it is what they meant.
#pragma once

#include <optional>

#include "libvpm/cloud/cloud.h"
#include "libvpm/import/remark.h"

namespace vpm {

struct DepthRange {
  float nearest = 0, median = 0, farthest = 0;  // m along the optical axis
};

struct ScanFacts {
  std::optional<DepthRange> depth;  // set for images in which something was measured
  double measured = 0;              // share of pixels or points
  Vec3 low, high;                   // corners of the box about the cloud's points, world, m
};

// Returns the numbers as the parameter `intrinsics` takes them: "fx,fy,cx,cy".
std::string intrinsics_text(const Intrinsics& intrinsics);

// Returns for example "0.8 m".
std::string metres_text(double length);

// Returns the range of the depths of the measured pixels; nothing if none was measured.
std::optional<DepthRange> range_of(const DepthImage& depth);

// Returns the facts of a cloud made of an image or points of which `invalid` of `all` were not
// measured.
ScanFacts facts_of(const Cloud& cloud, std::size_t invalid, std::size_t all);

// Returns warnings about depths and shares that no sensor gives, usually for a wrong unit. Names
// the one that was told if it is less than one unit per metre.
Remarks improbable_depths(const ScanFacts& facts,
                          const std::optional<double>& units_per_metre = std::nullopt);
// Returns warnings about intrinsics that no camera of this image has.
Remarks improbable_intrinsics(const Camera& camera);

// Returns for example "depth 0.43 to 0.95 m, median 0.6 m; 86 % measured; 0.9 x 0.6 x 0.5 m".
std::string words_of(const ScanFacts& facts);

}  // namespace vpm
