// Solid bounded by triangles, from which a packing is made.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

// Vertex indices, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

// Welded, closed and outward-oriented triangles. Vertices in metres.
struct Solid {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

struct MassProperties {
  double volume = 0;    // m^3
  Vec3 center_of_mass;  // centroid of the solid, m
};

// Returns the exact integrals by the divergence theorem. Works about the centre of the bounding
// box, so that a far origin costs no digits.
MassProperties mass_properties(const Solid& solid);

// Returns the largest distance of a vertex from `from`.
double bounding_radius(const Solid& solid, Vec3 from);

// Returns 32 hexadecimal digits that identify the solid: XXH3-128 of counts, vertices and triangles
// as stored.
std::string content_hash(const Solid& solid);

}  // namespace vpm
