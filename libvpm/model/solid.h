// A solid bounded by triangles: what a packing was made of.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

using Triangle =
    std::array<std::uint32_t, 3>;  // vertex indices, counter-clockwise seen from outside

// Welded, closed, consistently oriented outward. Coordinates in metres (after --scale).
struct Solid {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

struct MassProperties {
  double volume = 0;    // m^3
  Vec3 center_of_mass;  // of a homogeneous solid
};

// Exact integrals by the divergence theorem, about the box's centre so that a far origin costs no
// digits.
MassProperties mass_properties(const Solid& solid);

// Largest distance of a vertex from `from`.
double reach(const Solid& solid, Vec3 from);

// 32 hexadecimal digits that identify the solid: XXH3-128 over counts, vertices and triangles as
// stored.
std::string content_hash(const Solid& solid);

}  // namespace vpm
