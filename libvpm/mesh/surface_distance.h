// Distance between two surfaces.
#pragma once

#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

// Returns the largest distance, m, of a point of `from` to the surface `to`. Samples the vertices
// and points of triangles at most `spacing` apart, so that the true value is at most `spacing`
// larger. The maximum over both directions is the Hausdorff distance.
double farthest_from_surface(const Solid& from, const Solid& to, double spacing);

}  // namespace vpm
