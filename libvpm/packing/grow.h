// Lets all spheres of a packing grow together.
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "libvpm/mesh/outer_surface.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

struct GrowOptions {
  const Enclosure* enclosure = nullptr;  // enclosure of the solid, or null to compute it
  double min_radius = 0;                 // m; no sphere shrinks below this
  double max_radius = std::numeric_limits<double>::infinity();  // m; no sphere grows above this
  int steps = 100;                                              // limit; fewer if no more is gained
  // Called between steps on the calling thread.
  std::function<void(double fraction)> progress = nullptr;
};

// Grows a packing of the solid and returns as many spheres, largest first, with at least the same
// volume; the same spheres if nothing is gained.
//
// A greedy packing gives its first spheres all the room there is. Here all centres and radii move
// at once to maximise the sum of volumes. Distances to triangles and spheres are convex, so their
// linearisations bound them from below: each step is a linear programme whose solution is again a
// packing, and so is every intermediate state. More than kGrownTogether spheres move in groups of
// neighbours, divided differently in each step. When that converges, the smallest spheres move to
// where larger ones fit by now, and all grow again.
//
// Deterministic for any number of threads; scaling by 2^k changes exponents only. Throws
// Error(invalid_argument) for limits that are not numbers, Error(refused) for a solid without
// extent.
std::vector<Sphere> grow(const Solid& solid, const std::vector<Sphere>& spheres,
                         const GrowOptions& options);

// Size of a group; a step of one takes about 50 ms.
inline constexpr std::size_t kGrownTogether = 256;

}  // namespace vpm
