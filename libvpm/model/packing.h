// A packing: non-overlapping spheres inside a solid, largest first, with the solid they came from.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Every prefix of `spheres` is a packing too: levels of detail are prefixes.
struct Packing {
  std::vector<Sphere> spheres;
  Solid solid;
  nlohmann::json provenance;  // tool, version, parameters, hash of the input; never a clock time
};

}  // namespace vpm
