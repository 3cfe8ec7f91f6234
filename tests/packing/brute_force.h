// A second opinion on packings: every triangle and every pair, no acceleration, long double.
#pragma once

#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm::test {

double distance_to_mesh(const Solid& solid, Vec3 x);
bool encloses(const Solid& solid, Vec3 x);  // sum of solid angles is not zero

// Largest radius - signed distance to the mesh, largest r_i + r_j - |c_i - c_j|. A solid that meets
// itself is given as its enclosed_surface.
double worst_protrusion(const Solid& solid, const std::vector<Sphere>& spheres);
double worst_overlap(const std::vector<Sphere>& spheres);

// Signed clearance of x beside all spheres but number `except`.
double clearance(const Solid& solid, const std::vector<Sphere>& spheres, Vec3 x,
                 std::size_t except);

}  // namespace vpm::test
