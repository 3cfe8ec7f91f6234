// Fills what room is left in a solid, one band of radii at a time.
#pragma once

#include <cstddef>

#include "libvpm/packing/space.h"

namespace vpm {

// So many spheres take the places that suit the others (Candidates::place_closest).
inline constexpr std::size_t kFirstSpheres = 200;

// Places spheres of at least `radius`, cut to `cap`, largest first as far as they compete, until
// none fits or `most` are there. The space is focused on the radius.
void fill_band(Space& space, double radius, double cap, std::size_t most);

}  // namespace vpm
