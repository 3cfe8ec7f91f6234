// Fills the room left in a solid, one band of radii at a time.
#pragma once

#include <cstddef>

#include "libvpm/packing/space.h"

namespace vpm {

// Number of spheres that are placed into contact, to fill tubes well.
inline constexpr std::size_t kFirstSpheres = 200;

// Places spheres of at least `radius`, cut to `cap`, until none fits or there are `most`; larger
// ones first where they compete for room. Radii must not grow from call to call.
void fill_band(Space& space, double radius, double cap, std::size_t most);

}  // namespace vpm
