#pragma once

#include <cstddef>

#include "libvpm/model/solid.h"

namespace vpm::view {

// Returns a mesh of about `triangles` at most, for drawing: vertices within a cell of a grid become
// one, triangles that lose a corner by it go. The solid itself where it is small enough.
Solid simplified(const Solid& solid, std::size_t triangles);

}  // namespace vpm::view
