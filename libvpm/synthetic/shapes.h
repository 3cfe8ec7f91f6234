// Closed solids with outward orientation, centred at the origin. Lengths in metres.
#pragma once

#include <string>

#include "libvpm/model/solid.h"

namespace vpm::synthetic {

Solid make_box(double a, double b, double c);  // edges along x, y, z: needles and sheets too
Solid make_cube(double edge);

// Regular; a corner points along +z, so that a motion along z makes contact with it.
Solid make_tetrahedron(double edge);
Solid make_octahedron(double edge);

// An icosahedron whose triangles were cut into four `subdivisions` times, corners on the sphere.
Solid make_icosphere(double radius, int subdivisions);

// About the z axis: `around` segments of the ring, `across` of the tube.
Solid make_torus(double ring_radius, double tube_radius, int around, int across);

// A torus whose square cross-section (edge `edge`) makes `quarter_turns` quarter turns on its way
// around the ring.
Solid make_twisted_torus(double ring_radius, double edge, int quarter_turns, int around);

// A tube about the (p, q) torus knot, which winds p times around the z axis and q times around the
// ring's core; p and q have no common divisor. The tube must be thin enough not to meet itself.
Solid make_torus_knot(int p, int q, double ring_radius, double coil_radius, double tube_radius,
                      int around, int across);

// Writes the solid as OFF with 17 digits, which is lossless. Throws Error(cannot_write).
void write_off(const std::string& path, const Solid& solid);

}  // namespace vpm::synthetic
