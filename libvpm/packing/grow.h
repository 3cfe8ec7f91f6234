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
  const Enclosure* enclosure = nullptr;                         // of the solid, where it is known
  double min_radius = 0;                                        // m; no sphere shrinks below
  double max_radius = std::numeric_limits<double>::infinity();  // m; no sphere grows above
  int steps = 100;  // at most; fewer where no more is gained
  std::function<void(double fraction)> progress =
      nullptr;  // called between steps, on the calling thread
};

// A greedy packing gives the first spheres all the room there is; here all centres and radii move
// at once for the largest sum of volumes. Distances to triangles and to other spheres are convex,
// so their linearisations bound them from below: each step is a linear programme whose solution is
// a packing again, and every intermediate state is valid. More than kGrownTogether spheres move in
// neighbouring groups, divided otherwise in every step. Where that ends, the smallest spheres move
// to where larger ones fit by now, and all grow again.
//
// `spheres`: a packing of the solid, as pack() gives it. Returns as many spheres, largest first,
// with at least the same volume; the same spheres where nothing is gained. Deterministic for any
// number of threads; scaling by 2^k changes exponents only.
// Throws Error: usage for limits that are no numbers, refused for a solid without extent.
std::vector<Sphere> grow(const Solid& solid, const std::vector<Sphere>& spheres,
                         const GrowOptions& options);

inline constexpr std::size_t kGrownTogether = 256;  // a step of so many takes about 50 ms

}  // namespace vpm
