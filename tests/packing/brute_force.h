// A second opinion on packings: every triangle and every pair, no acceleration, long double.
#pragma once

#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm::test {

double distance_to_mesh(const Solid& solid, Vec3 x);
bool encloses(const Solid& solid, Vec3 x);  // true if the sum of solid angles is not zero

// Returns the largest radius - signed distance to the mesh, and the largest r_i + r_j - |c_i -
// c_j|. A solid that intersects itself is given as its enclosed_surface.
double worst_protrusion(const Solid& solid, const std::vector<Sphere>& spheres);
double worst_overlap(const std::vector<Sphere>& spheres);

// Returns the signed clearance of x beside all spheres but number `except`.
double separation(const Solid& solid, const std::vector<Sphere>& spheres, Vec3 x,
                  std::size_t except);

}  // namespace vpm::test
