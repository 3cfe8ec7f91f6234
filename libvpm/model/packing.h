// Packing: non-overlapping spheres inside a solid, largest first, with that solid. Metres.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Every prefix of `spheres` is a packing too; levels of detail are prefixes.
struct Packing {
  std::vector<Sphere> spheres;
  Solid solid;
  // Tool, version, parameters, hash of the input; no clock time, so that equal runs give equal
  // files.
  nlohmann::json provenance;
};

}  // namespace vpm
