// Finds the pinhole camera that an organised cloud was taken with.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include "libvpm/cloud/camera.h"
#include "libvpm/import/point_files.h"

namespace vpm {

// Largest distance, in pixels, between a point's place in the grid and where the pinhole camera
// sees it; beyond, the grid is not that camera's.
inline constexpr double kPinholeTolerance = 0.5;

// Camera whose pixels see the points of a grid.
struct PinholeFit {
  Intrinsics intrinsics;
  double residual = HUGE_VAL;  // largest distance of a point from its pixel, px
  std::size_t point = 0;       // the point that is so far off

  bool fits() const { return residual <= kPinholeTolerance; }
};

// Returns the pinhole camera (x right, y down, z forward) by least squares of u = fx x/z + cx and v
// = fy y/z + cy, or the residual of the camera given. Its residual is infinite if too few points
// have z > 0 or focal lengths are not positive.
PinholeFit fit_pinhole(const PointSet& points);
PinholeFit fit_of(const PointSet& points, const Intrinsics& intrinsics);

// Returns for example "point (3, 4) is 2.1 pixels from where …", or that the grid is turned or
// mirrored, for one that does not fit.
std::string words_of(const PinholeFit& fit, const PointSet& points);

// Returns what would make such a grid readable; `is_placed` tells that its camera's pose is known.
std::string cure_of(const PointSet& points, bool is_placed);

}  // namespace vpm
