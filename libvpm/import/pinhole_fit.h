// Depth images of organised clouds.
#pragma once

#include <string>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/import/point_set.h"

namespace vpm {

// Largest distance, in pixels, between a point's place in the grid and where the pinhole camera
// sees it; beyond, the grid is not that camera's.
inline constexpr double kPinholeTolerance = 0.5;

// Returns the pinhole camera (x right, y down, z forward) whose pixels see the points, by least
// squares of u = fx x/z + cx and v = fy y/z + cy. Throws Error(refused) if the points determine no
// camera or none fits to kPinholeTolerance, naming the residual.
Intrinsics fit_pinhole(const PointSet& points, const std::string& name);

// Throws Error(refused), naming the residual, if the points do not fit the camera.
void check_pinhole(const PointSet& points, const Intrinsics& k, const std::string& name);

// Returns z of every point in metres; 0 where nothing was measured.
DepthImage depth_of(const PointSet& points, double units_per_metre);

}  // namespace vpm
