// How near to the surface of a solid the spheres of its packing come.
#pragma once

#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Metres; the gap of a point of the mesh is its distance to the nearest sphere's surface, 0 within
// a sphere.
struct SurfaceGap {
  double mean = 0;
  double p95 = 0;      // 95 % of the surface have at most this
  double largest = 0;  // over the mesh's vertices too, where gaps are largest
};

// Over 50 000 points, spread evenly over the area of the mesh. Needs at least one sphere and a
// solid with an extent. The same for any number of threads.
SurfaceGap surface_gap(const Solid& solid, const std::vector<Sphere>& spheres);

}  // namespace vpm
