// Smooth solids for the benchmark of packings: fine meshes that one sphere, or a few, nearly fill,
// and that leave a narrow room of nearly equal width all around.
#pragma once

#include <string>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm::bench {

struct SmoothSolid {
  std::string name;
  Solid solid;  // about 1 m in radius
};

// Returns a capsule, whose packing is the yardstick, then balls of 5120, 20 480 and 81 920
// triangles, one of 82 368 in meridians and parallels, and others that are nearly round. With
// `quick`, only the capsule and the smallest ball.
std::vector<SmoothSolid> smooth_solids(bool quick);

}  // namespace vpm::bench
