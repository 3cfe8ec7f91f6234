// A tool whose truth needs no integration: a cube of equal spheres, each with a small cube for its
// share.
#pragma once

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/synthetic/scenes.h"

namespace vpm::testing {

// Edge length `edge`, centred at the origin, `spheres` per edge, `samples` per edge of each share.
ToolModel lattice_cube(double edge, std::uint32_t spheres, std::uint32_t samples);

// Places in such a cube, `per_edge` along each edge.
std::vector<Vec3> places_in_cube(double edge, int per_edge);

// What the camera of a scene sees, with the surface's own normals.
Cloud see(const synthetic::Scene& scene);

// A generic rotation, so that nothing is aligned by chance.
Rotation generic_rotation();

Cloud permuted(const Cloud& cloud);  // the points in another order
Cloud doubled(const Cloud& cloud);   // every point twice

}  // namespace vpm::testing
