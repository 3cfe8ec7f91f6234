// Pairs of solids for the measure of one against another.
#pragma once

#include <string>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/model/solid.h"

namespace vpm::bench {

// Two solids of some 0.1 m, b turned beside a and moved along a direction.
struct PairOfSolids {
  std::string name;
  Solid a, b;
  Vec3 turn;  // rotation vector of b
  Vec3 way;   // direction from a's centre of mass to b's
};

// Returns convex, concave, thin, mechanical, bumpy, enclosed and coincident pairs of 4 to 82 000
// triangles, `quick` without those of more than 2000, and pairs of the meshes bunny.off, spot.obj,
// fandisk.obj, knot.ply and armadillo.obj that are in the folder `meshes`, if one is named.
std::vector<PairOfSolids> pairs_of_solids(bool quick, const std::string& meshes);

}  // namespace vpm::bench
