// Volume that two meshes share, by other means than the library's measure, as its reference.
#pragma once

#include "libvpm/model/solid.h"

namespace vpm::synthetic {

// Returns the volume of what both solids contain, m^3, right to rounding (1e-13 of either). Both
// must be closed and oriented outward, in one frame. A solid is the sum of the columns below its
// triangles, those that face down counted negative; two columns share the prism over their common
// shadow up to the lower of their tops. So no position is a special case: flush, coplanar and
// coincident faces included. Takes time of the number of pairs of triangles whose shadows meet.
double shared_volume(const Solid& a, const Solid& b);

}  // namespace vpm::synthetic
