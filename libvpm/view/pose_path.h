// Tells poses that follow each other from poses in no order.
#pragma once

#include <span>

#include "libvpm/core/vec3.h"

namespace vpm::view {

// True if places in this order are those of a motion: the way through them is at most half as long
// again as the shortest tree that joins them. A random order of ten places or more is longer. Takes
// a time that grows with the square of their number.
bool is_path(std::span<const Vec3> places);

}  // namespace vpm::view
