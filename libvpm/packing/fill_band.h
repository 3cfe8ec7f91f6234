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

// Places spheres as fill_band() does, but searches only `most` blocks, and takes few spheres of
// each at a time, so that room may be left; with `until_none_fits` it goes on until there is none.
// For rooms so small that their order decides no coverage: the shell about the ball in a ball has
// tens of thousands of equal ones, which can neither be told apart nor be filled to the last.
void fill_roughly(Space& space, double radius, double cap, std::size_t most, bool until_none_fits);

}  // namespace vpm
