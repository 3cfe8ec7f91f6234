// How far two surfaces lie apart.
#pragma once

#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

// The largest distance from a point of the first surface to the second, in metres: over the
// vertices of the first and points of its triangles at most `spacing` apart, so that the true value
// is at most `spacing` larger. The larger one of both directions is the Hausdorff distance.
double farthest_from_surface(const Solid& from, const Solid& to, double spacing);

}  // namespace vpm
