// Cuts the large triangles of a surface into facets.
#pragma once

#include "libvpm/model/solid.h"

namespace vpm {

// Returns the solid with edges no longer than `longest`, m: the longest edge is halved first, with
// both its triangles, so that the surface stays closed. Vertices keep their indices; new ones
// follow.
Solid cut_into_facets(const Solid& solid, double longest);

}  // namespace vpm
