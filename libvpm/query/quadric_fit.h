// Fits a paraboloid to scattered points by least squares, for the local shape of a surface.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "libvpm/core/vec3.h"

namespace vpm {

struct QuadricFit {
  double residual = 0;   // root mean square, corrected for the six parameters, m
  double curvature = 0;  // larger principal curvature at the place, absolute, 1/m
};

// Fits the height over the plane through `place` with the unit normal `normal`. Returns nothing
// where the points do not determine it.
std::optional<QuadricFit> fit_quadric(std::span<const Vec3> points, Vec3 place, Vec3 normal);

}  // namespace vpm
