// Makes a cloud of points that have normals and no camera, and says what looks wrong about them.
#pragma once

#include <string>

#include "libvpm/cloud/cloud.h"
#include "libvpm/import/point_set.h"
#include "libvpm/import/remark.h"

namespace vpm {

struct ScatteredScan {
  Cloud cloud;
  std::size_t invalid = 0;         // points that are not finite
  std::size_t without_normal = 0;  // finite, but not in the cloud
  Remarks remarks;
};

// Returns the cloud of points in metres. A file with a viewpoint has its sensor at the origin of
// its frame, towards which normals must point. Throws Error(refused), naming `name`, for points
// without normals.
ScatteredScan scan_of_scattered(const PointSet& points, const Pose& to_world,
                                const std::string& name);

}  // namespace vpm
