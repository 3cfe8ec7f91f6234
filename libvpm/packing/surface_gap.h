// Distance of a packing's spheres from the solid's surface.
#pragma once

#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Gaps in metres. The gap of a point of the mesh is its distance to the nearest sphere's surface, 0
// inside a sphere.
struct SurfaceGap {
  double mean = 0;
  double p95 = 0;      // 95 % quantile over the area
  double largest = 0;  // maximum over samples and vertices, where gaps are largest
};

// Measures the gap at 50 000 points spread evenly over the area of the mesh. Needs at least one
// sphere and a solid with an extent. The same for any number of threads.
SurfaceGap surface_gap(const Solid& solid, const std::vector<Sphere>& spheres);

}  // namespace vpm
