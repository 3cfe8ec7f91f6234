#pragma once

#include <span>

#include "libvpm/model/sphere.h"

namespace vpm {

// Returns a sphere that encloses all of at least one sphere, within about 1 % of the smallest such
// one. After Badoiu and Clarkson, the centre steps towards the farthest sphere by ever shorter
// steps. Holds as computed in double: norm(bound.center - s.center) + s.radius <= bound.radius.
Sphere enclosing_sphere(std::span<const Sphere> spheres);

// Returns the radius with which a sphere about `center` encloses all spheres.
double enclosing_radius(Vec3 center, std::span<const Sphere> spheres);

}  // namespace vpm
