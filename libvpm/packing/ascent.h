// Ascent from a point to a local maximum of the clearance.
#pragma once

#include <cmath>

#include "libvpm/model/sphere.h"
#include "libvpm/packing/space.h"

namespace vpm {

// Returns the largest sphere reached from `start`, a point inside the solid with clearance `from`.
//
// Distances to triangles and spheres are convex, so their linearisations bound them from below.
// Each step solves the linear programme over the obstacles met so far: it never overestimates, and
// an unforeseen obstacle shortens the step. No step is longer than `longest_step`. The result
// touches four obstacles (fewer where the maximum is flat), to rounding; the ascent never lowers
// the clearance and never crosses the mesh.
Sphere ascend(const Space& space, Vec3 start, const SeparationBound& from,
              double longest_step = HUGE_VAL);

}  // namespace vpm
