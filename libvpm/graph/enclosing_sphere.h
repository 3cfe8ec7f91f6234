#pragma once

#include <span>

#include "libvpm/model/sphere.h"

namespace vpm {

// A sphere that encloses all of the spheres (at least one), within about 1 % of the smallest one:
// after Badoiu and Clarkson, the centre steps towards the farthest sphere, ever shorter. Holds in
// double precision: norm(bound.center - s.center) + s.radius <= bound.radius as computed.
Sphere enclosing_sphere(std::span<const Sphere> spheres);

// The radius that makes a sphere about `center` enclose them.
double enclosing_radius(Vec3 center, std::span<const Sphere> spheres);

}  // namespace vpm
