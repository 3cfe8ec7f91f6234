// From a point to the local maximum of the clearance.
#pragma once

#include <cmath>

#include "libvpm/model/sphere.h"
#include "libvpm/packing/space.h"

namespace vpm {

// The largest sphere reached from `start`, a point inside of the solid with clearance `from`.
//
// Distances to triangles and spheres are convex, so their linearisations bound them from below: the
// step of the linear programme over the obstacles met so far never overestimates, and an obstacle
// that was not foreseen cuts the step off. No step is longer than `longest_step`. The sphere
// touches four obstacles (fewer where the maximum is flat), to rounding. Never lowers the
// clearance, and stays on its side of the mesh.
Sphere ascend(const Space& space, Vec3 start, const Clearance& from,
              double longest_step = HUGE_VAL);

}  // namespace vpm
