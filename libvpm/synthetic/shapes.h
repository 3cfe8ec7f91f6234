// Closed solids, oriented outward, centred at the origin. Lengths in metres.
#pragma once

#include <string>

#include "libvpm/model/solid.h"

namespace vpm::synthetic {

// Returns a box with edges of these lengths along x, y and z; needles and sheets are allowed.
Solid make_box(double a, double b, double c);
Solid make_cube(double edge);

// Return regular solids with a corner towards +z, so that a motion along z makes contact with it.
Solid make_tetrahedron(double edge);
Solid make_octahedron(double edge);

// Returns an icosahedron whose triangles are cut into four `subdivisions` times, with corners on
// the sphere.
Solid make_icosphere(double radius, int subdivisions);

// Returns a torus about the z axis with `around` segments of the ring and `across` of the tube.
Solid make_torus(double ring_radius, double tube_radius, int around, int across);

// Returns a torus with a square cross-section of this edge that makes `quarter_turns` quarter turns
// along the ring.
Solid make_twisted_torus(double ring_radius, double edge, int quarter_turns, int around);

// Returns a tube about the (p, q) torus knot, which winds p times around the z axis and q times
// around the ring's core. Needs coprime p and q, and a tube thin enough not to meet itself.
Solid make_torus_knot(int p, int q, double ring_radius, double coil_radius, double tube_radius,
                      int around, int across);

// Writes the solid as OFF with 17 digits, hence losslessly. Throws Error(cannot_write).
void write_off(const std::string& path, const Solid& solid);

}  // namespace vpm::synthetic
